"""What a sharp low-pass makes of Coulomb friction beside a reversal.

The torque behind a two-sided low-pass rings where friction jumps: half a period of the bandwidth
away by 14 % of the friction, a whole period away by 4 %. The sign of the smoothed velocity does not
ring. How much there is depends on the joint: all of it if it turns at once, next to none if it
sticks for longer than a period. Therefore the ringing of the friction of a joint is a column of its
own, beside those of the parameters.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.regression.low_pass import LowPass
from scarid_cli.algorithms.regression.rows import Rows, runs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.jackknife import block_numbers
from scarid_cli.arrays import Array

SHORTEST = 0.5  # periods of the cut-off, of a run that may have rows away from its reversals
BLOCKS = 5.0  # effective ones, below which the error of an estimate is not known


def with_ringing(rows: Rows, robot: Robot) -> Rows:
    """The rows with further columns: the ringing of each Coulomb friction.

    There are none if the low-pass behind the rows is not known to be a two-sided Butterworth
    filter, nor for a friction that reverses in too few blocks of time.
    """
    low_pass = LowPass.behind(rows)
    if low_pass is None:
        return rows
    columns = [c for c in _columns(rows, robot, low_pass) if _determined(rows, c)]
    if not columns:
        return rows
    return replace(rows, W=np.concatenate((rows.W, np.stack(columns, axis=2)), axis=2))


def _columns(rows: Rows, robot: Robot, low_pass: LowPass) -> Iterator[Array]:
    """The ringing (samples, joints) of the frictions of a joint, or of a motor of two joints."""
    long = [run for run in runs(rows.at) if (run.stop - run.start) * low_pass.cutoff > SHORTEST]
    frictions: dict[tuple[int, ...], list[int]] = {}
    for index, parameter in enumerate(robot.parameters):
        if parameter.term.JUMPS:
            frictions.setdefault(parameter.term.joints, []).append(index)
    for joints, indices in frictions.items():
        column = np.zeros(rows.y.shape)
        for j in (joint - 1 for joint in joints):
            friction = rows.W[:, j, indices].sum(axis=1)
            for run in long:
                if np.ptp(friction[run]) > 0.0:  # else rounding alone would be left
                    column[run, j] = low_pass.over(friction[run]) - friction[run]
        yield column


def _determined(rows: Rows, column: Array) -> bool:
    """Whether the power of a column (samples, joints) is that of enough blocks of time."""
    power = np.sum((column * (rows.scales > 0.0)) ** 2, axis=1)
    blocks = np.bincount(block_numbers(rows.at, rows.h)[0], weights=power)
    return bool(blocks.sum() ** 2 >= BLOCKS * (blocks**2).sum() > 0.0)
