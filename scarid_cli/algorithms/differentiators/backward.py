"""Backward (Euler) difference, once for velocity, twice for acceleration: no filter.

For positions that are filtered already, online. Delay: half a sample for the velocity, one sample
for the acceleration. Matched (--match): the velocity is averaged over two samples, position and
torque are delayed by one. No settings.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.recursion import Causal, Derivatives, Recursion
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(Causal):
    def matched(self) -> Matched:
        return Matched()

    def init(self, q: float, h: float) -> Recursion:
        return Recursion(np.array([q, q]), h)

    def step(self, state: Recursion, q: Array) -> tuple[Recursion, Derivatives]:
        samples = np.concatenate((state.values, q))
        v = np.diff(samples) / state.h
        return replace(state, values=samples[-2:]), (v[1:], np.diff(v) / state.h)


@dataclass(frozen=True)
class Matched(Differentiator):
    """Both differences are central about the sample before."""

    @property
    def companion(self) -> Delay:
        return Delay()

    def step(self, state: Recursion, q: Array) -> tuple[Recursion, Derivatives]:
        samples = np.concatenate((state.values, q))
        v = (samples[2:] - samples[:-2]) / (2.0 * state.h)
        after, (_, a) = super().step(state, q)
        return after, (v, a)


@dataclass(frozen=True)
class Delay:
    """The sample before."""

    def init(self, x: float, h: float) -> Recursion:
        return Recursion(np.array([x]), h)

    def step(self, state: Recursion, x: Array) -> tuple[Recursion, Array]:
        samples = np.concatenate((state.values, x))
        return replace(state, values=samples[-1:]), samples[:-1]
