"""Derivatives of the polynomial that fits a window of samples best (Savitzky and Golay)."""

from __future__ import annotations

from typing import Any

import numpy as np

from scarid_cli.algorithms.settings import require_whole
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


def require_window(settings: Any) -> None:
    """`window` and `degree` must be whole, and make a fit with a second derivative."""
    require_whole(settings, "window", "degree")
    if settings.degree < 2:
        raise UsageFault(f"degree must be at least 2, not {settings.degree:g}")
    if settings.window <= settings.degree:
        raise UsageFault(
            f"window must be longer than the degree, {settings.degree:g}, not {settings.window:g}"
        )


def derivative_taps(window: int, degree: int, age: int, h: float) -> tuple[Array, Array]:
    """First and second derivative at the sample `age` periods h [s] ago, newest sample first."""
    # Chebyshev's polynomials on -1..1: powers would be nearly dependent.
    x = np.linspace(1.0, -1.0, window)
    at = x[age]
    scale = (window - 1) * h / 2.0
    fit = np.linalg.pinv(np.polynomial.chebyshev.chebvander(x, degree))
    rows = []
    for order in (1, 2):
        basis = np.polynomial.chebyshev.chebder(np.eye(degree + 1), order)
        value = np.polynomial.chebyshev.chebval(at, basis)
        rows.append(value @ fit / scale**order)
    return rows[0], rows[1]
