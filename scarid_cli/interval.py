"""What stands behind +- wherever scarid prints it: half the 95 % interval."""

from __future__ import annotations

HALF = 1.959964  # standard errors, of a normal distribution


def plus_minus(error: float, digits: int = 2) -> str:
    """`+- 0.0025` for a standard error: half the 95 % interval, with these significant digits."""
    return f"+- {HALF * error:.{digits}g}"
