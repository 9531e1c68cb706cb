"""Settings of algorithms, and the checks that refuse settings which make no sense.

Every check raises a UsageFault whose message names the setting and its value.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields
from math import inf
from typing import Any

from scarid_cli.errors import UsageFault

# Metadata of a field that is not a setting: the stage fills it in.
GIVEN = {"given": True}
LONGEST = 0.05  # s, of the period of a usual log: longer ones are likely in another unit


class Validated:
    """A frozen dataclass of settings that are checked once, when it is made.

    Fields declared `int` must be whole numbers and are converted: the command line passes 81.0,
    the algorithm sees 81.
    """

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]  # subclasses are dataclasses
            if field.type in (int, "int"):
                value = getattr(self, field.name)
                if not abs(value) < inf or value % 1:
                    raise UsageFault(f"{field.name} must be a whole number, not {value:g}")
                object.__setattr__(self, field.name, int(value))
        self.check()

    def check(self) -> None:
        """Raise a UsageFault if a setting makes no sense; by default every value is accepted."""


def names_of(method: Any) -> list[str]:
    """The names of the settings of an algorithm, given its class or an instance."""
    return [f.name for f in fields(method) if "given" not in f.metadata]


def require_positive(settings: Any, *names: str) -> None:
    """Each named setting must be finite and above zero."""
    _require(settings, names, lambda x: 0.0 < x < inf, "be positive")


def require_positive_or_infinite(settings: Any, *names: str) -> None:
    """Each named setting is a limit: it must be above zero, and may be infinite."""
    _require(settings, names, lambda x: x > 0.0, "be positive")


def require_not_negative(settings: Any, *names: str) -> None:
    """Each named setting must be finite, and zero or above."""
    _require(settings, names, lambda x: 0.0 <= x < inf, "not be negative")


def require_odd(settings: Any, *names: str) -> None:
    """Each named setting must be an odd number."""
    _require(settings, names, lambda x: x % 2 == 1, "be odd")


def require_between(settings: Any, low: int, high: int, *names: str) -> None:
    """Each named setting, declared `int`, must be from low to high."""
    what = f"be a whole number from {low} to {high}"
    _require(settings, names, lambda x: low <= x <= high, what)


def require_above(settings: Any, low: float, *names: str) -> None:
    """Each named setting must be finite and above low."""
    _require(settings, names, lambda x: low < x < inf, f"be above {low:g}")


def _require(settings: Any, names: Sequence[str], fits: Callable[[float], bool], what: str) -> None:
    for name in names:
        value = getattr(settings, name)
        if not fits(value):
            raise UsageFault(f"{name} must {what}, not {value:g}")


def require_below_nyquist(cutoff: float, h: float) -> None:
    """The cutoff [Hz] must be below half the rate of a signal sampled every h [s]."""
    if cutoff * h >= 0.5:
        doubt = "; is the time in seconds?" if h > LONGEST else ""
        raise UsageFault(f"cutoff {cutoff:g} Hz is not below half the rate, {0.5 / h:g} Hz{doubt}")
