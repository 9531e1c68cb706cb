"""Tails of Student's t and of the F distribution, without scipy, which takes long to import."""

from __future__ import annotations

from math import exp, inf, lgamma, log, log1p

MOST_TERMS = 500
CLOSE = 1e-15  # relative change at which the continued fraction has converged


def log_tail_f(value: float, k: float, n: float) -> float:
    """The logarithm of the probability that F with k and n degrees of freedom exceeds a value.

    It is the incomplete beta function I(x; n/2, k/2) at x = n / (n + k F) (Abramowitz and Stegun
    26.6.2); its logarithm does not underflow.
    """
    if not value > 0.0:
        return 0.0
    if value == inf:
        return -inf
    return _log_beta(n / (n + k * value), k * value / (n + k * value), 0.5 * n, 0.5 * k)


def log_tail_t(value: float, n: float) -> float:
    """The logarithm of the probability that |t| with n degrees of freedom exceeds |value|."""
    return log_tail_f(value * value, 1.0, n)


def _log_beta(x: float, rest: float, a: float, b: float) -> float:
    """log I(x; a, b), where rest = 1 - x."""
    if x <= 0.0 or rest <= 0.0:
        return -inf if x <= 0.0 else 0.0
    front = lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log(rest)
    if x < (a + 1.0) / (a + b + 2.0):
        return front + log(_fraction(x, a, b) / a)
    return log1p(-min(exp(front) * _fraction(rest, b, a) / b, 1.0 - 1e-16))


def _fraction(x: float, a: float, b: float) -> float:
    """The continued fraction of the incomplete beta function (26.5.8), by Lentz's method."""
    c, d = 1.0, 1.0 / (1.0 - (a + b) * x / (a + 1.0))
    total = d
    for m in range(1, MOST_TERMS):
        for term in (
            m * (b - m) * x / ((a + 2 * m - 1.0) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1.0)),
        ):
            d = 1.0 / (1.0 + term * d)
            c = 1.0 + term / c
            total *= c * d
        if abs(c * d - 1.0) < CLOSE:
            break
    return total
