"""Which mismatches (beyond/gears.py) may explain what the torques are beyond the model.

A column of each, for a small size, stands beside W. Sets of columns that are clear are tried with
the whole estimation, whose columns are those of the sizes found.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import MISMATCHES
from scarid_cli.algorithms.beyond.gears import Gears, LatePosition, LateTorque
from scarid_cli.algorithms.effects.effects import CERTAIN, Effect, Trial
from scarid_cli.algorithms.effects.explanations import RARE, Explanation, Torques
from scarid_cli.algorithms.regression.low_pass import LowPass
from scarid_cli.algorithms.regression.rows import Rows, runs, slope
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.products import Products, jackknifed
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array

# The part of a column that may be noise of the positions: it is .7 where steps of 20 um
# were taken for an elastic joint, and .1 where one is (docs/design/verdict.md).
NOISE = 0.3


def mismatches(trial: Trial, effects: Sequence[Effect]) -> tuple[Explanation, ...]:
    """The sets of mismatches that may explain the torques, those that leave least first.

    All of a set must be clear in the whole estimation.
    """
    products, places = trial.mismatches
    pool = {column: (x, j) for x, own in places.items() for j, column in enumerate(own)}
    if not pool or products.eliminated is None:
        return ()
    joints = trial.rows.y.shape[1]
    names = {*MISMATCHES, *(effect.name for effect in effects)}
    level = CERTAIN / len(names)  # each is an alternative
    least, strict = (
        quantile(1.0 - 0.5 * x / joints, trial.count - 1) for x in (CERTAIN, RARE / CERTAIN * level)
    )
    further = _Further(products, pool, least)
    sets = [further.kept([k for k in pool if pool[k][0] == name]) for name in MISMATCHES]
    sets += further.chosen()
    found = {frozenset(pool[k] for k in own): own for own in sets if own}
    found = {x: own for x, own in found.items() if not _common(x, joints)}
    if any(_steady(x) for x in found) and LowPass.behind(trial.rows):
        slower = [_Further(one, pool, least) for one in _slower(trial)]
        own = {column: pool[column] for each in found.values() for column in each}
        shaken = _shaken(trial, {c: x for c, x in own.items() if _steady([x])})
        found = {
            x: each
            for x, each in found.items()
            if not _steady(x)
            or (shaken.isdisjoint(each) and any(one.clear(each) for one in slower))
        }
    order = sorted(found, key=lambda x: further.left(found[x]))
    clearness = max((float(further.ratios(own).max()) for own in found.values()), default=0.0)
    cycles = trial.ripples.cycles
    return tuple(Explanation(x, clearness / least, strict, cycles, least) for x in order)


def _common(torques: Torques, joints: int) -> bool:
    """Whether all joints are late, which is the delay of the torques that is fitted anyway."""
    names = [name for name, _ in torques]
    return any(names.count(late) == joints for late in (LatePosition.NAME, LateTorque.NAME))


def _steady(torques: Iterable[tuple[str, int]]) -> bool:
    """Whether they show at all times: what jumps has its place near reversals."""
    return not any(MISMATCHES[name].JUMPS for name, _ in torques)


def _slower(trial: Trial) -> list[Products]:
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
    plain = replace(trial, noise=None, places=np.arange(rows.samples))
    tried = [trial, plain] if trial.noise else [plain]
    return [replace(x, rows=slow).products(scales, columns)[0] for x in tried]


def _passed(rows: Rows, low_pass: LowPass, x: Array) -> Array:
    """Columns (samples, joints, ...) of these rows behind a further low-pass."""
    found = np.empty_like(x)
    for run in runs(rows.at):
        for j in range(x.shape[1]):
            found[run, j] = low_pass.over(x[run, j])
    return found


def _shaken(trial: Trial, pool: dict[int, tuple[str, int]]) -> set[int]:
    """Those of the columns of a `pool` of which noise of the positions is a part that counts.

    Such a column takes away a part of the noise of the accelerations, as a sharper low-pass would:
    its size is then 1.3 over the square of the bandwidth [rad/s], whatever the robot.
    """
    rows, low_pass, model = trial.rows, LowPass.behind(trial.rows), trial.model
    if low_pass is None or model is None or len(rows.noise) != rows.y.shape[1]:
        return set()
    white = np.random.default_rng(0).standard_normal(rows.y.shape)
    velocities = slope(rows, _passed(rows, low_pass, white))
    velocities *= np.array(rows.noise) / velocities.std(axis=0)
    motion = rows.motion.copy()
    motion[1:3] += np.stack((velocities.T, slope(rows, velocities).T))
    theta = trial.estimates[: trial.own]
    still, moved = (Gears(x, model, theta) for x in (rows, replace(rows, motion=motion)))
    plain = replace(trial, noise=None, places=np.arange(rows.samples))
    products = plain.products(rows.scales, trial.secants)[0]

    def share(column: int) -> float:
        kind, joint = MISMATCHES[pool[column][0]], pool[column][1]
        noise = (kind.secant(moved, joint) - kind.secant(still, joint)) * rows.scales
        left = products.left_of(column)
        return float(np.sum((noise * trial.weights) ** 2)) / left if left else 0.0

    return {column for column in pool if share(column) > NOISE}


@dataclass(frozen=True)
class _Further:
    """Sets of further columns of a `pool`, whose sizes are above 0 by `least` errors or more."""

    products: Products
    pool: Collection[int]
    least: float

    def ratios(self, columns: list[int]) -> Array:
        """The sizes in units of their errors."""
        found = self.products.solved(columns)
        if found is None:
            return np.zeros(len(columns))
        own = slice(self.products.parameters, None)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = found.whole[own] / jackknifed(found.deviations[:, own])
        return np.asarray(np.nan_to_num(ratios))

    def clear(self, columns: list[int]) -> bool:
        """Whether all of them are above 0 by more than the least errors."""
        return bool(np.all(self.ratios(columns) > self.least))

    def kept(self, columns: list[int]) -> list[int]:
        """Those of the columns that are left when the one that is least clear goes, as need be."""
        columns = self.products.independent(columns)
        while columns:
            ratios = self.ratios(columns)
            worst = int(np.argmin(ratios))
            if ratios[worst] > self.least:
                break
            del columns[worst]
        return columns

    def chosen(self) -> list[list[int]]:
        """The sets that grow by the column that leaves least, as long as all are clear."""
        sets, kept = list[list[int]](), list[int]()
        while new := self._beside(kept):
            kept = [*kept, min(new, key=lambda c: self.left([*kept, c]))]
            if np.min(self.ratios(kept)) <= self.least:
                break
            sets.append(kept)
        return sets

    def _beside(self, kept: list[int]) -> list[int]:
        """The columns that may stand beside those that are kept."""
        rest = [c for c in self.pool if c not in kept]
        there = len(self.products.independent(kept))
        new = (c for c in rest if len(self.products.independent([*kept, c])) > there)
        return [c for c in new if self.ratios([*kept, c])[-1] > 0.0]

    def left(self, columns: list[int]) -> float:
        """The part of the squares of the torques that is left beside these columns."""
        assert self.products.eliminated is not None
        rest = self.products.eliminated.rest[0]
        own = [c - self.products.parameters for c in columns]
        fit = np.linalg.lstsq(rest[np.ix_(own, own)], rest[own, -1], rcond=None)[0]
        return float(rest[-1, -1] - rest[own, -1] @ fit)
