"""Checks that the settings of an algorithm make sense; a UsageFault says which does not."""

from __future__ import annotations

from dataclasses import fields
from math import inf
from typing import Any

from scarid_cli.errors import UsageFault

# Metadata of a field that is no setting: the stage fills it in.
GIVEN = {"given": True}


def names_of(method: Any) -> list[str]:
    """The settings of an algorithm, of its class or of one with values."""
    return [f.name for f in fields(method) if "given" not in f.metadata]


def require_positive(settings: Any, *names: str) -> None:
    """Each named setting must be finite and above zero."""
    for name in names:
        if not 0.0 < getattr(settings, name) < inf:
            raise UsageFault(f"{name} must be positive, not {getattr(settings, name):g}")


def require_positive_or_infinite(settings: Any, *names: str) -> None:
    """Each named setting, a limit, must be above zero."""
    for name in names:
        if not getattr(settings, name) > 0.0:
            raise UsageFault(f"{name} must be positive, not {getattr(settings, name):g}")


def require_not_negative(settings: Any, *names: str) -> None:
    """Each named setting must be finite and zero or above."""
    for name in names:
        if not 0.0 <= getattr(settings, name) < inf:
            raise UsageFault(f"{name} must not be negative, not {getattr(settings, name):g}")


def require_whole(settings: Any, *names: str) -> None:
    """Each named setting must be a whole number."""
    for name in names:
        if not abs(getattr(settings, name)) < inf or getattr(settings, name) % 1:
            raise UsageFault(f"{name} must be a whole number, not {getattr(settings, name):g}")


def require_odd(settings: Any, *names: str) -> None:
    """Each named setting must be an odd number."""
    for name in names:
        if getattr(settings, name) % 2 != 1:
            raise UsageFault(f"{name} must be odd, not {getattr(settings, name):g}")


def require_between(settings: Any, low: float, high: float, *names: str) -> None:
    """Each named setting must be a whole number from low to high."""
    for name in names:
        if getattr(settings, name) % 1 or not low <= getattr(settings, name) <= high:
            raise UsageFault(
                f"{name} must be a whole number from {low:g} to {high:g}, "
                f"not {getattr(settings, name):g}"
            )


def require_below_nyquist(cutoff: float, h: float) -> None:
    """A cut-off [Hz] that a signal sampled every h [s] can have."""
    if cutoff * h >= 0.5:
        raise UsageFault(f"cutoff {cutoff:g} Hz is not below half the rate, {0.5 / h:g} Hz")


def require_above(settings: Any, low: float, *names: str) -> None:
    """Each named setting must be finite and above low."""
    for name in names:
        if not low < getattr(settings, name) < inf:
            raise UsageFault(f"{name} must be above {low:g}, not {getattr(settings, name):g}")
