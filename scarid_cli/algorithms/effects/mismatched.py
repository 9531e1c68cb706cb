"""Which mismatches (beyond/gears.py) may explain what the torques are beyond the model.

A column of each, for a small size, stands beside W. Sets of columns that are clear are tried with
the whole estimation, whose columns are those of the sizes found.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import MISMATCHES
from scarid_cli.algorithms.beyond.gears import LatePosition, LateTorque
from scarid_cli.algorithms.effects.effects import CERTAIN, Effect, Trial
from scarid_cli.algorithms.effects.explanations import RARE, Explanation, Torques
from scarid_cli.algorithms.effects.steady import shaken, slower
from scarid_cli.algorithms.regression.low_pass import LowPass
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.products import Products, jackknifed
from scarid_cli.arrays import Array


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
        behind = [_Further(one, pool, least) for one in slower(trial)]
        own = {column: pool[column] for each in found.values() for column in each}
        noisy = shaken(trial, {c: x for c, x in own.items() if _steady([x])})
        found = {
            x: each
            for x, each in found.items()
            if not _steady(x) or (noisy.isdisjoint(each) and any(one.clear(each) for one in behind))
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
