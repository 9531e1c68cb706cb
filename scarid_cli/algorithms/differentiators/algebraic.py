"""Algebraic differentiator: a Jacobi polynomial expansion over a sliding window.

Causal. Mboup, Join and Fliess, Numer. Algorithms 50 (2009) 439; survey by Othmane, Kiltz and
Rudolph (2022). It is sampled as in the toolbox AlgDiff: "analytic" for the velocity, "analytic
trapezoidal" for the acceleration.
Delay: window (alpha + 1) / (alpha + beta + 2) for degree 0.
Matched (exact): position and torque pass the kernel of which the derivatives are differences.
Rule: choose the window by the delay that can be accepted.
window = 0.1 [s]: length of the window, rounded to whole samples.
alpha = 4, beta = 4: exponents of the weight (1 - x)^alpha (1 + x)^beta, each above 1.
degree = 0: degree of the expansion, 0 to 6; above 0 it is evaluated at the last zero of the next
polynomial.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import gamma
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.settings import require_above, require_between, require_positive
from scarid_cli.algorithms.filters.convolution import FirMethod
from scarid_cli.algorithms.filters.polynomials import require_moderate
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


@dataclass(frozen=True)
class Differentiator(FirMethod):
    window: float = 0.1
    alpha: float = 4.0
    beta: float = 4.0
    degree: int = 0

    TUNED: ClassVar = {"window": Range(0.02, 1.0, narrows=True)}

    def check(self) -> None:
        require_positive(self, "window")
        require_above(self, 1.0, "alpha", "beta")
        require_between(self, 0, 6, "degree")

    def taps(self, h: float) -> tuple[Array, ...]:
        lowpass = self.lowpass(h)
        first, second = np.array([1.0, -1.0, 0.0]) / h, np.array([1.0, -2.0, 1.0]) / h**2
        return np.convolve(lowpass, first), np.convolve(lowpass, second)

    def lowpass(self, h: float) -> Array:
        require_moderate(self.window / h)
        samples = round(self.window / h)
        if samples < 3:
            raise UsageFault(f"window must be 3 samples or more, not {self.window / h:.3g}")
        x = 1.0 - 2.0 * np.arange(1, samples) / samples
        kernel = np.zeros_like(x)
        at = last_zero(self.degree + 1, self.alpha, self.beta) if self.degree else 0.0
        for n in range(self.degree + 1):
            share = jacobi(n, self.alpha, self.beta, np.array(at))
            share /= squared_norm(n, self.alpha, self.beta)
            kernel += share * jacobi(n, self.alpha, self.beta, x)
        kernel *= (1.0 - x) ** self.alpha * (1.0 + x) ** self.beta
        kernel /= kernel.sum()
        return kernel


def jacobi(n: int, alpha: float, beta: float, x: Array) -> Array:
    """The Jacobi polynomial of degree n at x."""
    total = np.zeros_like(x)
    for s in range(n + 1):
        weight = binomial(n + alpha, n - s) * binomial(n + beta, s)
        total += weight * ((x - 1.0) / 2.0) ** s * ((x + 1.0) / 2.0) ** (n - s)
    return total


def binomial(x: float, k: int) -> float:
    """The binomial coefficient x over k, for a real x of at least k."""
    return gamma(x + 1.0) / (gamma(k + 1.0) * gamma(x - k + 1.0))


def squared_norm(n: int, alpha: float, beta: float) -> float:
    """The integral of the weight times the squared polynomial, over 2^(alpha + beta + 1)."""
    return (
        gamma(n + alpha + 1.0)
        * gamma(n + beta + 1.0)
        / (gamma(n + 1.0) * (2.0 * n + alpha + beta + 1.0) * gamma(n + alpha + beta + 1.0))
    )


def last_zero(n: int, alpha: float, beta: float) -> float:
    """The largest zero of the Jacobi polynomial of degree n, for alpha and beta above 1.

    As an eigenvalue (Golub and Welsch, Math. Comp. 23 (1969) 221).
    """
    k = np.arange(n)
    total = 2.0 * k + alpha + beta
    diagonal = (beta**2 - alpha**2) / (total * (total + 2.0))
    k, total = k[1:], total[1:]
    square = (
        4.0 * k * (k + alpha) * (k + beta) * (k + alpha + beta)
        / (total**2 * (total + 1.0) * (total - 1.0))
    )  # fmt: skip
    beside = np.diag(np.sqrt(square), 1)
    return float(np.linalg.eigvalsh(np.diag(diagonal) + beside + beside.T)[-1])
