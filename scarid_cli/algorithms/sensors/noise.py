"""Sources of noise, each with a random stream of its own."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace
from zlib import crc32

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import sos


def stream(seed: int, name: str) -> np.random.Generator:
    """The random stream of this name: those of other names do not change it."""
    sequence = np.random.SeedSequence(seed, spawn_key=(crc32(name.encode()),))
    return np.random.default_rng(sequence)


@dataclass(frozen=True)
class Source:
    """Random numbers drawn one after the other; a step leaves the state before it alone."""

    generator: np.random.Generator

    @classmethod
    def named(cls, seed: int, name: str) -> Source:
        return cls(stream(seed, name))

    def normal(self, *shape: int) -> tuple[Source, Array]:
        """The next normal numbers of unit variance, in this shape."""
        after = deepcopy(self.generator)
        return Source(after), after.standard_normal(shape)

    def uniform(self, *shape: int) -> tuple[Source, Array]:
        """The next numbers from 0 to 1, in this shape."""
        after = deepcopy(self.generator)
        return Source(after), after.random(shape)


@dataclass(frozen=True)
class NoiseState:
    """The source of a noise, and the sums (joints, 1, 2) of its filters."""

    source: Source
    sums: Array


@dataclass(frozen=True)
class GaussMarkov:
    """Coloured noise: n(k+1) = a n(k) + s sqrt(1 - a^2) w(k), a = exp(-h / T), per joint.

    The deviations s (joints) are in units of the signal, the correlation times T (joints) and the
    period h in seconds. The process is stationary from its first sample on. This is the exact
    discretisation of dn/dt = -n / T + s sqrt(2 / T) w (Gelb, Applied Optimal Estimation, 1974).
    """

    deviations: Array
    times: Array
    h: float

    @property
    def memory(self) -> Array:
        """The factors a (joints); 0 for white noise."""
        slow = self.times > 0.0
        return np.where(slow, np.exp(-self.h / np.where(slow, self.times, 1.0)), 0.0)

    def init(self, source: Source) -> NoiseState:
        """The state before the first sample, drawn from the stationary distribution."""
        source, before = source.normal(len(self.deviations))
        sums = np.zeros((len(self.deviations), 1, 2))
        sums[:, 0, 0] = self.memory * self.deviations * before
        return NoiseState(source, sums)

    def step(self, state: NoiseState, ticks: int) -> tuple[NoiseState, Array]:
        """The state after so many samples, and the samples (joints, ticks)."""
        source, white = state.source.normal(ticks, len(self.deviations))
        state = replace(state, source=source, sums=state.sums.copy())
        noise = np.empty((len(self.deviations), ticks))
        for j, a in enumerate(self.memory):
            drive = np.ascontiguousarray(white[:, j]) * (self.deviations[j] * np.sqrt(1.0 - a * a))
            sos.filtered(drive, noise[j], state.sums[j], np.array([[1.0, 0.0, 0.0, -a, 0.0]]))
        return state, noise
