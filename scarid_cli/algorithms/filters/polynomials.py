"""Least-squares polynomials over a window of samples, and their derivatives.

Savitzky and Golay, Anal. Chem. 36 (1964) 1627.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

LONGEST_WINDOW = 20_000  # samples; a longer one would take hours


def require_moderate(samples: float) -> None:
    """Refuse a window [samples] over which a fit would take hours."""
    if samples > LONGEST_WINDOW:
        raise UsageFault(f"window must be {LONGEST_WINDOW} samples or less, not {samples:.6g}")


def require_window(settings: Any) -> None:
    """`window` and `degree` must make a polynomial fit that has a second derivative."""
    if settings.degree < 2:
        raise UsageFault(f"degree must be at least 2, not {settings.degree:g}")
    if settings.window <= settings.degree:
        raise UsageFault(
            f"window must be longer than the degree, {settings.degree:g}, not {settings.window:g}"
        )
    require_moderate(settings.window)


def derivative_taps(window: int, degree: int, order: int, age: int, h: float) -> Array:
    """The taps of a derivative of this order at the sample `age` periods h [s] ago.

    The tap of the newest sample comes first.
    """
    # In Chebyshev polynomials on -1..1, for powers would be nearly dependent.
    x = np.linspace(1.0, -1.0, window)
    scale = (window - 1) * h / 2.0
    basis = np.polynomial.chebyshev.chebder(np.eye(degree + 1), order)
    value = np.polynomial.chebyshev.chebval(x[age], basis)
    taps: Array = value @ fitting(window, degree) / scale**order
    return taps


@cache
def fitting(window: int, degree: int) -> Array:
    """The matrix (degree + 1, window) from samples to Chebyshev coefficients of the polynomial."""
    x = np.linspace(1.0, -1.0, window)
    return np.asarray(np.linalg.pinv(np.polynomial.chebyshev.chebvander(x, degree)), dtype=float)
