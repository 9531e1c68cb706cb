"""The range in which `scarid tune` searches a setting."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Range:
    """The range of a setting, searched on a logarithmic scale.

    If `samples` is true, the range is in seconds and the setting in samples. If `step` is not 0,
    the setting is rounded to one of 1, 1 + step, 1 + 2 step, ...; if it is 0, any number is taken.
    If `narrows` is true, a larger setting narrows the bandwidth, as a longer window does.
    """

    low: float
    high: float
    samples: bool = False
    step: int = 0
    narrows: bool = False

    def setting(self, x: float, h: float) -> float:
        """The setting at x of the unit interval, for a record sampled every h [s]."""
        value: float = self.low * (self.high / self.low) ** min(max(x, 0.0), 1.0)
        if self.samples:
            value /= h
        return self._rounded(value)

    def scaled(self, value: float, factor: float) -> float:
        """The setting that widens the bandwidth by about a factor, from a value of the setting."""
        return self._rounded(value / factor if self.narrows or self.samples else value * factor)

    def _rounded(self, value: float) -> float:
        if self.step:
            return 1 + self.step * max(round((value - 1) / self.step), 1)
        return value
