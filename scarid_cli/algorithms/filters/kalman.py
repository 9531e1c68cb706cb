"""Kalman filtering of a position whose acceleration is an integrated or damped random process.

State: position, velocity, acceleration and derivatives of the acceleration, down to white noise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from scarid_cli.algorithms.choices.settings import (
    require_between,
    require_not_negative,
    require_positive,
    require_positive_or_infinite,
)
from scarid_cli.arrays import Array
from scarid_cli.kernels import kalman

# Before the first sample: the variance of each derivative [SI units], and how many deviations of
# differences of the noise it is at most. Beyond, a smoother would lose all digits.
START, WIDE = 1e3, 1e4


@dataclass(frozen=True)
class State:
    """The predicted state and its covariance, the last gain, and the workings of the kernel."""

    x: Array
    P: Array
    gain: Array
    work: Array
    model: Model

    def copy(self) -> State:
        """A state that a kernel may change in place."""
        return State(self.x.copy(), self.P.copy(), self.gain.copy(), self.work.copy(), self.model)

    @property
    def settled(self) -> bool:
        """Whether the gain has come to rest."""
        return bool(self.work[1])

    @property
    def likelihood(self) -> float:
        """Logarithm of the likelihood of the samples so far, but for a constant for each."""
        return float(self.work[0])


@dataclass(frozen=True)
class Model:
    """x(k+1) = F x(k) + w, cov w = Q; the first state is measured.

    noise: the variance of the measurement, and the squared number of standard deviations that
    make an innovation a glitch. start: variances of the states before the first measurement.
    """

    F: Array
    Q: Array
    noise: Array
    start: Array

    def at_rest(self, x: float) -> State:
        """The state before the first measurement x of a motion of which nothing else is known."""
        m = len(self.F)
        first = np.zeros(m)
        first[0] = x
        return State(first, np.diag(self.start), np.zeros(m), np.zeros(5 + m * (m + 1)), self)


@dataclass(frozen=True)
class Settings:
    """What the Kalman differentiators have in common."""

    noise: float = 5e-5
    intensity: float = 10000.0
    states: int = 4
    damping: float = 0.0
    frequency: float = 0.0
    gate: float = 20.0

    def __post_init__(self) -> None:
        self.require_noise()
        require_between(self, 3, 5, "states")
        require_not_negative(self, "damping", "frequency")
        require_positive_or_infinite(self, "gate")

    def require_noise(self) -> None:
        """A smoother that tunes itself takes 0 as well."""
        require_positive(self, "noise", "intensity")

    def observer(self, x: float, h: float) -> State:
        """The filter at rest at x, its gain settled."""
        first = np.eye(int(self.states))[0] * x
        return replace(settled(self, h), x=first)

    def model(self, h: float) -> Model:
        F, Q = discretised(int(self.states), self.damping, self.frequency, h)
        variance = self.noise**2
        orders = np.arange(1, int(self.states))
        start = np.minimum(START, variance * (WIDE / h**orders) ** 2)
        noise = np.array([variance, self.gate**2])
        return Model(F, self.intensity * Q, noise, np.concatenate(([variance], start)))


def discretised(states: int, damping: float, frequency: float, h: float) -> tuple[Array, Array]:
    """F and Q (for unit intensity) of the sampled chain, by Van Loan's matrix exponential.

    The acceleration a is white noise through the inverse of s, s^2 + w^2 or s (s^2 + w^2), with
    s + damping in the place of s and w the frequency; with neither, a plain chain of integrators.
    """
    orders = states - 2
    characteristic = np.poly(poles(orders, damping, frequency)).real
    # In units of h, h^2, ... the matrices are of the order of one.
    scale = h ** np.arange(states)
    A = np.diag(np.ones(states - 1), 1)
    A[-1, 2:] = -characteristic[:0:-1] * h ** np.arange(orders, 0, -1)
    noise = np.zeros((states, states))
    noise[-1, -1] = 1.0
    block = np.block([[-A, noise], [np.zeros_like(A), A.T]])
    power = exponential(block)
    F = power[states:, states:].T
    Q = F @ power[:states, states:]
    # White noise of unit density over h adds h^(2 states - 1) in these units.
    F = F * scale[None, :] / scale[:, None]
    Q = 0.5 * (Q + Q.T) * h ** (2 * states - 1) / np.outer(scale, scale)
    return np.ascontiguousarray(F), np.ascontiguousarray(Q)


@lru_cache(maxsize=64)  # for every joint and its torque, and again for each check of the settings
def settled(settings: Settings, h: float) -> State:
    """The filter once its gain is at rest."""
    state = settings.model(h).at_rest(0.0)
    still = np.zeros(4096)
    for _ in range(1000):
        state, _ = filtered(state, still)
        if state.settled:
            break
    return state


def poles(orders: int, damping: float, frequency: float) -> list[complex]:
    """Of the acceleration process."""
    pair = [complex(-damping, frequency), complex(-damping, -frequency)]
    single = [complex(-damping, 0.0)]
    return {1: single, 2: pair, 3: pair + single}[orders]


def exponential(A: Array) -> Array:
    """exp(A), by squaring and Taylor's series."""
    squarings = max(0, int(np.ceil(np.log2(max(np.abs(A).sum(axis=1).max(), 1e-300)))))
    small = A / 2.0**squarings
    result = term = np.eye(len(A))
    for k in range(1, 25):
        term = term @ small / k
        result = result + term
    for _ in range(squarings):
        result = result @ result
    return result


def filtered(state: State, x: Array) -> tuple[State, Array]:
    """The state after the samples x, and the filtered states, a row for each."""
    state, model = state.copy(), state.model
    rows = np.empty((len(x), len(state.x)))
    kalman.filtered(
        x, rows, state.x, state.P, state.gain, state.work, model.F, model.Q, model.noise
    )
    return state, rows


@dataclass(frozen=True)
class Records:
    """What smoothing needs of each row."""

    predictions: Array
    innovations: Array
    steady: Array
    gains: Array
    covariances: Array

    @classmethod
    def of(cls, rows: int, states: int) -> Records:
        return cls(
            np.empty((rows, states)),
            np.empty(rows),
            np.empty(rows),
            np.empty((rows, states)),
            np.empty((rows, states, states)),
        )

    @property
    def arrays(self) -> tuple[Array, ...]:
        return self.predictions, self.innovations, self.steady, self.gains, self.covariances

    def __len__(self) -> int:
        return len(self.predictions)

    def last(self, rows: int) -> Records:
        start = max(len(self) - rows, 0)
        return Records(*(array[start:] for array in self.arrays))

    def followed_by(self, other: Records) -> Records:
        pairs = zip(self.arrays, other.arrays, strict=True)
        return Records(*(np.concatenate(pair) for pair in pairs))


def recorded(state: State, x: Array) -> tuple[State, Records]:
    """The state after the samples x, and the records of their rows."""
    state, model = state.copy(), state.model
    records = Records.of(len(x), len(state.x))
    kalman.recorded(
        x,
        *records.arrays,
        state.x,
        state.P,
        state.gain,
        state.work,
        model.F,
        model.Q,
        model.noise,
    )
    return state, records


def lag_weights(steady: State, lag: int) -> Array:
    """What an innovation adds to the state 0, 1, ... lag rows before it, the gain settled."""
    model = steady.model
    r = np.zeros(len(model.F))
    r[0] = 1.0
    rows = []
    for _ in range(lag + 1):
        rows.append(steady.P @ r)
        r = model.F.T @ r
        r[0] -= steady.gain @ r
    return np.array(rows)


def lagged(records: Records, rows: int, state: State, weights: Array) -> Array:
    """Velocity and acceleration of the first rows, each from the rows after it too."""
    out = np.empty((rows, 2))
    weights = np.ascontiguousarray(weights.T[1:3])
    room = np.empty(2 * len(state.x))
    kalman.lagged(*records.arrays, state.P, state.model.F, weights, out, room)
    return out


def smoothed(records: Records, state: State) -> Array:
    """Position, velocity and acceleration of every row, each from all rows."""
    out = np.empty((len(records), 3))
    room = np.empty(2 * len(state.x))
    kalman.smoothed(*records.arrays, state.P, state.model.F, out, room)
    return out
