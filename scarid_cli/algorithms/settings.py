"""Checks that the settings of an algorithm make sense; a UsageFault says which does not."""

from __future__ import annotations

from typing import Any

from scarid_cli.errors import UsageFault


def require_positive(settings: Any, *names: str) -> None:
    """Each named setting must be above zero."""
    for name in names:
        if not getattr(settings, name) > 0.0:
            raise UsageFault(f"{name} must be positive, not {getattr(settings, name):g}")


def require_not_negative(settings: Any, *names: str) -> None:
    """Each named setting must be zero or above."""
    for name in names:
        if not getattr(settings, name) >= 0.0:
            raise UsageFault(f"{name} must not be negative, not {getattr(settings, name):g}")
