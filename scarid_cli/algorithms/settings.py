"""Checks that the settings of an algorithm make sense; a UsageFault says which does not."""

from __future__ import annotations

from math import inf
from typing import Any

from scarid_cli.errors import UsageFault


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
