"""The Kalman filter of a measured position, and the smoothers that use its records.

The states are position, velocity, acceleration and, for 4 and 5 states, derivatives of the
acceleration. See docs/theory.md, section "Kalman filters and smoothers".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import kalman

# What the numbers in the kernel's `work` are (see kernels/kalman.py); from ROOM on it is work space
# for m (m + 1) numbers.
LIKELIHOOD, SETTLED, GLITCHES, LOG_VARIANCE, USUAL, ROOM = range(6)
KEPT = 2.0  # under SETTLED: a gain that is constant at glitches as well


@dataclass(frozen=True)
class KalmanState:
    """The predicted state (m) and its covariance (m, m), the last gain (m), and the kernel's work.

    Properties give names to what the kernel keeps by number.
    """

    x: Array
    P: Array
    gain: Array
    work: Array
    model: Model

    def copy(self) -> KalmanState:
        """A state that a kernel may change in place."""
        x, P, gain, work = (array.copy() for array in self.arrays)
        return KalmanState(x, P, gain, work, self.model)

    @property
    def arrays(self) -> tuple[Array, ...]:
        """All arrays, in the order in which the kernels take them."""
        return self.x, self.P, self.gain, self.work

    def with_constant_gain(self, gain: Array) -> KalmanState:
        """The state of a filter that keeps this gain (m), also where it leaves out a glitch."""
        work = self.work.copy()
        work[SETTLED] = KEPT
        return replace(self, gain=gain, work=work)

    @property
    def settled(self) -> bool:
        """Whether the gain has become constant."""
        return bool(self.work[SETTLED])

    @property
    def likelihood(self) -> float:
        """The logarithm of the likelihood of the samples so far, up to a constant per sample."""
        return float(self.work[LIKELIHOOD])


@dataclass(frozen=True)
class Model:
    """The linear model x(k+1) = F x(k) + w with cov w = Q, of which the first state is measured.

    noise: the variance of the measurement, and the square of the number of standard deviations
    beyond which an innovation is a glitch. start: the variances of the states before the first
    measurement (m).
    """

    F: Array
    Q: Array
    noise: Array
    start: Array

    @property
    def arrays(self) -> tuple[Array, ...]:
        """F, Q and noise, as the kernels take them."""
        return self.F, self.Q, self.noise

    @property
    def variance(self) -> float:
        """The variance of the measurement."""
        return float(self.noise[0])

    def at_rest(self, x: float) -> KalmanState:
        """The state before the first measurement x of a motion of which nothing else is known."""
        m = len(self.F)
        first = np.zeros(m)
        first[0] = x
        work = np.zeros(ROOM + m * (m + 1))
        return KalmanState(first, np.diag(self.start), np.zeros(m), work, self)


def filtered(state: KalmanState, x: Array) -> tuple[KalmanState, Array]:
    """The state after the positions x, and the filtered states (rows, m)."""
    state = state.copy()
    rows = np.empty((len(x), len(state.x)))
    kalman.filtered(x, rows, *state.arrays, *state.model.arrays)
    return state, rows


@dataclass(frozen=True)
class Records:
    """What a smoother needs of each row of the filter.

    predictions (rows, m): of the state. innovations (rows): over their variance. steady (rows): 1
    where the gain is constant. gains (rows, m). covariances (rows, m, m): of the predictions,
    written only where not steady.
    """

    predictions: Array
    innovations: Array
    steady: Array
    gains: Array
    covariances: Array

    @classmethod
    def of(cls, rows: int, states: int) -> Records:
        """Room for the records of so many rows."""
        m = states
        sizes: tuple[tuple[int, ...], ...] = ((rows, m), (rows,), (rows,), (rows, m), (rows, m, m))
        return cls(*(np.empty(size) for size in sizes))

    @property
    def arrays(self) -> tuple[Array, ...]:
        """All arrays, in the order in which the kernels take them."""
        return self.predictions, self.innovations, self.steady, self.gains, self.covariances

    def __len__(self) -> int:
        return len(self.predictions)

    def first(self, rows: int) -> Records:
        """The records of the first rows."""
        return Records(*(array[:rows] for array in self.arrays))

    def last(self, rows: int) -> Records:
        """The records of the last rows, copied so that the rest can be freed."""
        start = max(len(self) - rows, 0)
        return Records(*(array[start:].copy() for array in self.arrays))

    @classmethod
    def joined(cls, parts: Sequence[Records]) -> Records:
        """The records of rows that follow each other; at least one of them."""
        if len(parts) == 1:
            return parts[0]
        pieces = zip(*(part.arrays for part in parts), strict=True)
        return cls(*(np.concatenate(piece) for piece in pieces))


def recorded(state: KalmanState, x: Array) -> tuple[KalmanState, Records]:
    """The state after the positions x, and the records of their rows."""
    state = state.copy()
    records = Records.of(len(x), len(state.x))
    kalman.recorded(x, *records.arrays, *state.arrays, *state.model.arrays)
    return state, records


def lag_weights(steady: KalmanState, lag: int) -> Array:
    """What an innovation adds to the states 0 to `lag` rows before it (lag + 1, m).

    steady: a filter whose gain is constant.
    """
    model = steady.model
    r = np.zeros(len(model.F))
    r[0] = 1.0
    rows = []
    for _ in range(lag + 1):
        rows.append(steady.P @ r)
        r = model.F.T @ r
        r[0] -= steady.gain @ r
    return np.array(rows)


def lagged(records: Records, rows: int, state: KalmanState, weights: Array) -> Array:
    """Velocity and acceleration (rows, 2) of the first rows, each also from the rows after it."""
    out = np.empty((rows, 2))
    weights = np.ascontiguousarray(weights.T[1:3])
    room = np.empty(2 * len(state.x))
    kalman.lagged(*records.arrays, state.P, state.model.F, weights, out, room)
    return out


def smoothed(records: Records, state: KalmanState) -> Array:
    """Position, velocity and acceleration (rows, 3) of every row, each from all rows.

    state: a later one of the filter, whose gain is as constant as that of any of the rows.
    """
    out = np.empty((len(records), 3))
    room = np.empty(2 * len(state.x))
    kalman.smoothed(*records.arrays, state.P, state.model.F, out, room)
    return out
