"""The random process that the Kalman filters take the acceleration to be, in discrete time.

The acceleration is white noise through one, two or three integrators, damped or oscillating if the
settings say so. See docs/theory.md, section "Kalman filters and smoothers".
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from scarid_cli.arrays import Array


@lru_cache(maxsize=256)  # settings that are searched for differ in noise and intensity, mostly
def discretised(states: int, damping: float, frequency: float, h: float) -> tuple[Array, Array]:
    """The matrices F and Q (states, states) of the motion sampled every h [s], for unit intensity.

    The states are position, velocity, acceleration and its derivatives. The acceleration is white
    noise through the inverse of s, s^2 + w^2 or s (s^2 + w^2) for 3, 4 or 5 states, where s stands
    for s + damping [1/s] and w is the frequency [rad/s]; with neither it is a chain of integrators.
    They are exact, by Van Loan's matrix exponential (IEEE Trans. Autom. Control 23 (1978) 395), and
    shared: they must not be changed.
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


def poles(orders: int, damping: float, frequency: float) -> list[complex]:
    """The poles [rad/s] of an acceleration process of 1 to 3 orders."""
    pair = [complex(-damping, frequency), complex(-damping, -frequency)]
    single = [complex(-damping, 0.0)]
    return {1: single, 2: pair, 3: pair + single}[orders]


def exponential(A: Array) -> Array:
    """The matrix exponential of A, by scaling and squaring of the Taylor series.

    scipy has one too, but a streaming stage does not import scipy.
    """
    squarings = max(0, int(np.ceil(np.log2(max(np.abs(A).sum(axis=1).max(), 1e-300)))))
    small = A / 2.0**squarings
    result = term = np.eye(len(A))
    for k in range(1, 25):
        term = term @ small / k
        result = result + term
    for _ in range(squarings):
        result = result @ result
    return result
