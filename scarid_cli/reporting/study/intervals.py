"""The 95 % intervals of estimates, from the table or from the errors that it states."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, nan

from scarid_cli.reporting.kinds import Parameters

NORMAL = 1.96  # errors to either side, where the table states no interval


@dataclass(frozen=True)
class Interval:
    """An estimate and the ends of its 95 % interval, nan where they are not known."""

    estimate: float
    low: float
    high: float

    @property
    def half(self) -> float:
        return (self.high - self.low) / 2.0

    def holds(self, value: float) -> bool:
        """Whether the value lies in the interval."""
        return self.low <= value <= self.high

    def relative(self) -> float:
        """Half the interval in percent of the estimate; nan if it is not known."""
        return 100.0 * self.half / abs(self.estimate) if self.estimate else nan


def intervals(result: Parameters) -> list[Interval]:
    """The interval of each parameter.

    The table's own; else 1.96 robust standard errors to either side of the estimate; else 1.96
    standard deviations.
    """
    unknown = (nan,) * len(result.names)
    errors = zip(result.robust or unknown, result.deviations, strict=True)
    ends = zip(result.low or unknown, result.high or unknown, strict=True)
    return [
        _interval(estimate, end, robust if isfinite(robust) else plain)
        for estimate, end, (robust, plain) in zip(result.estimates, ends, errors, strict=True)
    ]


def _interval(estimate: float, ends: tuple[float, float], percent: float) -> Interval:
    if all(map(isfinite, ends)):
        return Interval(estimate, *ends)
    half = NORMAL * percent / 100.0 * abs(estimate)
    return Interval(estimate, estimate - half, estimate + half)
