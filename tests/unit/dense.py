"""Dense reference models of the Kalman methods: exact matrices, and joint Gaussians."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from unit.support import PERIOD as H

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters import kalman_method
from scarid_cli.arrays import Array

MODELS: dict[str, dict[str, float]] = {
    "white jerk": {"states": 3, "intensity": 1e3},
    "white snap": {"states": 4, "intensity": 1e4},
    "white crackle": {"states": 5, "intensity": 1e6},
    "oscillator": {"states": 4, "intensity": 1e4, "damping": 1.3, "frequency": 6.0},
    "Matern": {"states": 5, "intensity": 1e6, "damping": 4.0},
}


def continuous(states: int, damping: float = 0.0, frequency: float = 0.0) -> Array:
    """The continuous-time model: the acceleration process below two integrators."""
    s = np.polynomial.Polynomial([damping, 1.0])
    pair = s**2 + frequency**2
    characteristic = {3: s, 4: pair, 5: s * pair}[states].coef
    A = np.diag(np.ones(states - 1), 1)
    A[-1, 2:] = -characteristic[:-1]
    return A


def discrete(settings: dict[str, float]) -> tuple[Array, Array]:
    """F and Q of the sampled model, by Van Loan's method with scipy's matrix exponential."""
    m = int(settings["states"])
    A = continuous(m, settings.get("damping", 0.0), settings.get("frequency", 0.0))
    noise = np.zeros((m, m))
    noise[-1, -1] = settings["intensity"]
    block = expm(H * np.block([[-A, noise], [np.zeros((m, m)), A.T]]))
    F = block[m:, m:].T
    return F, F @ block[:m, m:]


def joint(rows: int, settings: dict[str, float], r: float) -> tuple[Array, Array]:
    """Covariance of all states, stacked, before any measurement; and of all measurements."""
    F, Q = discrete(settings)
    m = len(F)
    P = np.diag([r, *[kalman_method.START] * (m - 1)])
    cov = np.zeros((rows * m, rows * m))
    for i in range(rows):
        cross = P
        for j in range(i, rows):
            cov[j * m : (j + 1) * m, i * m : (i + 1) * m] = cross
            cov[i * m : (i + 1) * m, j * m : (j + 1) * m] = cross.T
            cross = F @ cross
        P = F @ P @ F.T + Q
    return cov, cov[::m, ::m] + r * np.eye(rows)


def method(name: str, settings: dict[str, float], **more: Any) -> Any:
    """A Kalman method with a known noise and no gate."""
    return DIFFERENTIATORS.load(name)(**settings, noise=2e-4, gate=np.inf, **more)


def drawn(settings: dict[str, float], sigma: float, rows: int, seed: int) -> Array:
    """Positions of the model itself, with white noise."""
    F, Q = discrete(settings)
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(Q + 1e-12 * np.diag(np.diag(Q)))
    x, q = np.zeros(len(F)), np.empty(rows)
    for k in range(rows):
        q[k] = x[0] + sigma * rng.standard_normal()
        x = F @ x + root @ rng.standard_normal(len(F))
    return q


def narrow(patch: pytest.MonkeyPatch) -> None:
    """Make the start known well enough for dense matrices to bear it."""
    patch.setattr(kalman_method, "START", 1.0)
