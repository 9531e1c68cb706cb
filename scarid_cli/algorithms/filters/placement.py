"""Observers of a chain of integrators with chosen poles."""

from __future__ import annotations

from math import inf

import numpy as np

from scarid_cli.algorithms.filters.acceleration import discretised
from scarid_cli.algorithms.filters.kalman import KalmanState, Model
from scarid_cli.arrays import Array


def observer_of(poles: Array, x: float, h: float) -> KalmanState:
    """The observer of a chain of integrators at rest at x, with these poles in discrete time."""
    m = len(poles)
    F, Q = discretised(m, 0.0, 0.0, h)
    model = Model(F, Q, np.array([1.0, inf]), np.ones(m))
    return model.at_rest(x).with_constant_gain(gain(poles, h))


def gain(poles: Array, h: float) -> Array:
    """The gain of the measurement with which F (I - K H) has these eigenvalues, one for each state.

    By Ackermann's formula; h [s].
    """
    m = len(poles)
    F, _ = discretised(m, 0.0, 0.0, 1.0)  # in units of h, h^2, ...
    observability = np.array([np.linalg.matrix_power(F, k)[0] for k in range(m)])
    wanted = np.eye(m)
    for pole in poles:
        wanted = wanted @ (F - pole * np.eye(m))
    predicted = wanted @ np.linalg.solve(observability, np.eye(m)[-1])
    filtered: Array = np.linalg.solve(F, predicted) / h ** np.arange(m)
    return filtered
