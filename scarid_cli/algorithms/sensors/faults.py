"""Faults of the rows of a log: outliers, repeated rows, lost rows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.sensors.noise import Source
from scarid_cli.arrays import Array, Marks

STREAMS = ("position-outliers", "torque-outliers", "repeated-rows", "lost-rows")


@dataclass(frozen=True)
class Outliers:
    """With a probability, plus or minus a size is added to a value; arrays (joints)."""

    probability: Array
    size: Array

    def step(self, source: Source, x: Array) -> tuple[Source, Array]:
        """The values x (joints, rows) with outliers."""
        source, chance = source.uniform(x.shape[1], x.shape[0])
        hit = self.probability[:, None] > chance.T
        up = 0.5 * self.probability[:, None] > chance.T
        jumped = x + np.where(up, 1.0, -1.0) * self.size[:, None]
        return source, np.where(hit, jumped, x)


@dataclass(frozen=True)
class FaultsState:
    """The random streams, and the values of the last row (columns, 1) once there is one."""

    sources: tuple[Source, ...]
    last: Array | None = None


@dataclass(frozen=True)
class Faults:
    """Outliers of positions and torques, and the probabilities of repeated and of lost rows."""

    positions: Outliers
    torques: Outliers
    repeated: float = 0.0
    lost: float = 0.0

    def init(self, seed: int) -> FaultsState:
        return FaultsState(tuple(Source.named(seed, name) for name in STREAMS))

    def step(self, state: FaultsState, values: Array) -> tuple[FaultsState, Array, Marks]:
        """What becomes of the rows, columns first: their values, and which of them are kept.

        The columns (columns, rows) are the positions, the torques and the reference.
        """
        joints, rows = len(self.positions.size), values.shape[1]
        of_q, of_tau, repeating, losing = state.sources
        of_q, q = self.positions.step(of_q, values[:joints])
        of_tau, tau = self.torques.step(of_tau, values[joints : 2 * joints])
        values = np.concatenate((q, tau, values[2 * joints :]))
        repeating, chance = repeating.uniform(rows)
        values = _held(state.last, values, chance < self.repeated)
        losing, lost = losing.uniform(rows)
        last = values[:, -1:] if rows else state.last
        after = FaultsState((of_q, of_tau, repeating, losing), last)
        return after, values, lost >= self.lost


def _held(last: Array | None, values: Array, repeat: Marks) -> Array:
    """The values of each row, or of the row before it where it is repeated."""
    before = values[:, :1] if last is None else last
    origin = np.where(repeat, 0, np.arange(1, len(repeat) + 1))
    held: Array = np.concatenate((before, values), axis=1)[:, np.maximum.accumulate(origin)]
    return held
