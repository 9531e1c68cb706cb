"""The 95 % intervals of estimates, from the table or from the errors that it states."""

from __future__ import annotations

from dataclasses import dataclass
from math import floor, isfinite, log10, nan

from scarid_cli.reporting.kinds import Parameters
from scarid_cli.reporting.parts import number

KNOWN = 2  # digits of half an interval, to which the estimate is rounded
MOST_PLACES = 9  # of a decimal number
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


def written(interval: Interval) -> tuple[str, str, str]:
    """The estimate, half its interval and the same in percent, to what is known of them.

    Each is empty or a dash if it is not known; the percentage of what may be 0 says nothing.
    """
    half = interval.half
    if not (isfinite(half) and half > 0.0 and isfinite(interval.estimate)):
        return number(interval.estimate), "", ""
    places = KNOWN - 1 - floor(log10(half))
    percent = interval.relative()
    share = f"{percent:.2g} %" if percent < 100.0 else ""
    estimate = _rounded(interval.estimate, places)
    return estimate, _rounded(half, places), share


def _rounded(value: float, places: int) -> str:
    """A number with so many decimal places, of which there are none if it is large."""
    if places > MOST_PLACES:
        return f"{value:.3g}"
    return f"{round(value, places):,.{max(places, 0)}f}"


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
