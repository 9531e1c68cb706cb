"""Kernel-based deadbeat differentiator of Volterra operators.

Causal. Li, Pin, Fedele and Parisini, Int. J. Control (2018), in discrete time: one filter
of one pole for each state, whose input is weighted by a function that rises from the start. From
the outputs of the filters follow the derivatives that explain them without any initial condition:
they are exact for polynomials of lower degree than the number of states, from the first estimate
on. It does not choose its bandwidth: after the start it is a linear observer with constant poles.
See docs/theory.md, section "The deadbeat differentiator".
Delay: none at constant jerk (4 states). On quintic moves of 0.8 to 2 s the acceleration lags by
20 ms at the default.
Matched (exact): position and torque pass the low-pass between position and highest derivative of
the observer after the start.
Rule: choose the bandwidth by the delay or the noise, as for high-gain.
bandwidth = 40 [rad/s]: geometric mean of the poles, and the rate at which the weights rise.
spread = 1.2: ratio of each pole to the one before, above 1.
states = 4: number of states, 3 to 5.
start = 0.05 [s]: time of the first estimate. Before it, velocity and acceleration are 0; the
earlier it is, the more they amplify the noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from math import comb, factorial
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import (
    require_above,
    require_between,
    require_not_negative,
    require_positive,
)
from scarid_cli.algorithms.filters.kalman import KalmanState
from scarid_cli.algorithms.filters.observer import ObserverMethod
from scarid_cli.algorithms.filters.placement import observer_of
from scarid_cli.algorithms.processes.matching import CentralDifferences
from scarid_cli.algorithms.processes.method import Matching, Method
from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import sos

DECAYED = 35.0  # time constants after which nothing is left of an exponential, exp(-35) = 6e-16
ROWS = 1_000_000  # at most, until the weights are constant


@dataclass(frozen=True)
class Schedule:
    """Weights of the input and of the outputs of the filters, row by row; the last row stays.

    inputs (states, rows): the weight of the position at the input of each filter. outputs
    (2, states, rows): the weights of the filters in velocity and acceleration. sections
    (states, 5): each filter, as the kernel `sos` takes it.
    """

    inputs: Array
    outputs: Array
    sections: Array


@dataclass(frozen=True)
class DeadbeatState:
    """The filters (states, 2), the number of rows so far, the first position, the schedule."""

    values: Array
    count: int
    first: float
    schedule: Schedule


@dataclass(frozen=True)
class Differentiator(Causal, Method):
    bandwidth: float = 40.0
    spread: float = 1.2
    states: int = 4
    start: float = 0.05

    MATCHING = Matching.EXACT
    TUNED: ClassVar = {"bandwidth": Range(3.0, 300.0)}

    def check(self) -> None:
        require_positive(self, "bandwidth")
        require_above(self, 1.0, "spread")
        require_between(self, 3, 5, "states")
        require_not_negative(self, "start")

    @property
    def poles(self) -> Array:
        """The distances of the poles from the origin [rad/s]."""
        powers = np.arange(self.states) - 0.5 * (self.states - 1)
        return np.asarray(self.bandwidth * self.spread**powers, dtype=np.float64)

    def init(self, x: float, h: float) -> DeadbeatState:
        return DeadbeatState(np.zeros((self.states, 2)), 0, x, scheduled(self, h))

    def step(self, state: DeadbeatState, x: Array) -> tuple[DeadbeatState, tuple[Array, ...]]:
        known, values = state.schedule, state.values.copy()
        last = known.inputs.shape[1] - 1
        rows = np.minimum(state.count + np.arange(len(x)), last)
        moved, filtered = x - state.first, np.empty_like(x)
        v, a = np.zeros_like(x), np.zeros_like(x)
        for i in range(self.states):
            one = slice(i, i + 1)
            sos.filtered(known.inputs[i, rows] * moved, filtered, values[one], known.sections[one])
            v += known.outputs[0, i, rows] * filtered
            a += known.outputs[1, i, rows] * filtered
        count = min(state.count + len(x), last)
        return replace(state, values=values, count=count), (v, a)

    def matched(self) -> CentralDifferences:
        return AfterStart(self).matched()


@dataclass(frozen=True)
class AfterStart(ObserverMethod):
    """The linear observer that the method is after its start."""

    method: Differentiator

    def init(self, x: float, h: float) -> KalmanState:
        return self.observer(x, h)

    def observer(self, x: float, h: float) -> KalmanState:
        """The observer at rest at x, with the poles of the filters."""
        return observer_of(np.exp(-self.method.poles * h), x, h)


@lru_cache(maxsize=64)  # for every joint
def scheduled(method: Differentiator, h: float) -> Schedule:
    """The schedule of a method at the sampling period h [s]."""
    poles, m = method.poles, method.states
    rows = int((DECAYED / method.bandwidth + DECAYED / poles[0]) / h) + m + 1
    if rows > ROWS:
        raise UsageFault(f"bandwidth must be larger for the period {h:g} s")
    decay = np.exp(-poles * h)
    inputs = (
        weights(poles, method.bandwidth, m, h * np.arange(rows, dtype=np.float64))
        * (1.0 - decay)[:, None]
    )
    outputs = np.zeros((rows, 2, m))
    first = min(max(round(method.start / h), m - 1), rows - 1)
    inverse = np.linalg.inv(moments(inputs, decay, method.bandwidth * h)[first:])
    outputs[first:] = inverse[:, 1:3] * method.bandwidth ** np.array([[1.0], [2.0]])
    sections = np.zeros((m, 5))
    sections[:, 0], sections[:, 3] = 1.0, -decay
    return Schedule(inputs, np.ascontiguousarray(np.moveaxis(outputs, 0, -1)), sections)


def weights(poles: Array, rise: float, m: int, t: Array) -> Array:
    """The derivatives of order m of the kernels, where they meet the present (poles, times).

    The kernel exp(-p (t - s)) (1 - exp(-rise s))^m and its derivatives by s up to order m - 1 are
    zero at s = 0, so that initial conditions drop out. In units of p^m; t [s], poles [rad/s].
    """
    total = np.zeros((len(poles), len(t)))
    for k in range(m + 1):
        rates = (poles - k * rise) / poles
        total += (-1.0) ** k * comb(m, k) * rates[:, None] ** m * np.exp(-k * rise * t)
    return total


def moments(inputs: Array, decay: Array, step: float) -> Array:
    """What the filters make of the monomials (s - t)^j / j!, for every present t (rows, m, m).

    Axis 1 counts filters, axis 2 powers j; times are in units in which the period is `step`.
    """
    m, rows = inputs.shape
    shift = np.array([[(-step) ** (j - i) / factorial(j - i) if j >= i else 0.0
                       for j in range(m)] for i in range(m)])  # fmt: skip
    found = np.zeros((rows, m, m))
    present = np.zeros((m, m))
    for k in range(rows):
        present = decay[:, None] * (present @ shift)
        present[:, 0] += inputs[:, k]
        found[k] = present
    return found
