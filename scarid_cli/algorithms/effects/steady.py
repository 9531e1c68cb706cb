"""Whether what looks like a mismatch shows at all speeds, and is not noise of the positions.

Near the bandwidth, friction of joints that stick and noise of the accelerations look like the
second derivative of a torque, and so like an elastic joint or a signal that is late.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import MISMATCHES
from scarid_cli.algorithms.beyond.gears import Gears
from scarid_cli.algorithms.effects.effects import Trial
from scarid_cli.algorithms.regression.low_pass import LowPass
from scarid_cli.algorithms.regression.rows import Rows, runs, slope
from scarid_cli.algorithms.uncertainty.products import Products
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array

# The part of a column that may be noise of the positions: it is .7 where steps of 20 um
# were taken for an elastic joint, and .1 where one is (docs/design/verdict.md).
NOISE = 0.3


def slower(trial: Trial) -> list[Products]:
    """The products behind a further low-pass of half the bandwidth, a period of it from reversals.

    Near the bandwidth, friction of joints that stick looks like the second derivative of a torque.
    They are whitened and not: a noise that was found without this low-pass may undo it.
    """
    rows, low_pass = trial.rows, LowPass.behind(trial.rows)
    assert low_pass
    assert rows.bandwidth
    half = replace(low_pass, cutoff=0.5 * low_pass.cutoff)
    scales = away_from_reversals(rows, 2.0 / rows.bandwidth)
    columns = {name: _passed(rows, half, x) for name, x in trial.secants.items()}
    slow = replace(rows, W=_passed(rows, half, rows.W), y=_passed(rows, half, rows.y))
    tried = [trial, _plain(trial)] if trial.noise else [trial]
    return [replace(x, rows=slow).products(scales, columns)[0] for x in tried]


def _passed(rows: Rows, low_pass: LowPass, x: Array) -> Array:
    """Columns (samples, joints, ...) of these rows behind a further low-pass."""
    found = np.empty_like(x)
    for run in runs(rows.at):
        for j in range(x.shape[1]):
            found[run, j] = low_pass.over(x[run, j])
    return found


def _plain(trial: Trial) -> Trial:
    """The same with rows that are not whitened."""
    if not trial.noise:
        return trial
    return replace(trial, noise=None, places=np.arange(trial.rows.samples))


def shaken(trial: Trial, pool: dict[int, tuple[str, int]]) -> set[int]:
    """Those of the columns of a `pool` of which noise of the positions is a part that counts.

    Such a column takes away a part of the noise of the accelerations, as a sharper low-pass would:
    its size is then 1.3 over the square of the bandwidth [rad/s], whatever the robot.
    """
    rows, low_pass, model = trial.rows, LowPass.behind(trial.rows), trial.model
    if low_pass is None or model is None or len(rows.noise) != rows.y.shape[1]:
        return set()
    white = np.random.default_rng(0).standard_normal(rows.y.shape)
    velocities = slope(rows, _passed(rows, low_pass, white))
    spread = velocities.std(axis=0)
    if not spread.all():  # too few rows
        return set()
    velocities *= np.array(rows.noise) / spread
    motion = rows.motion.copy()
    motion[1:3] += np.stack((velocities.T, slope(rows, velocities).T))
    moved = Gears(replace(rows, motion=motion), model, trial.estimates[: trial.own])
    products = _plain(trial).mismatches[0]

    def share(column: int) -> float:
        kind, joint = MISMATCHES[pool[column][0]], pool[column][1]
        noise = (kind.secant(moved, joint) - trial.secants[kind.NAME][:, :, joint]) * rows.scales
        left = products.left_of(column)
        return float(np.sum((noise * trial.weights) ** 2)) / left if left else 0.0

    return {column for column in pool if share(column) > NOISE}
