"""The range in which `scarid tune` searches a setting."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Range:
    """The range of a setting, searched on a logarithmic scale.

    If `samples` is true, the range is in seconds and the setting in samples. If `step` is not 0,
    the setting is rounded to one of 1, 1 + step, 1 + 2 step, ...; if it is 0, any number is taken.
    """

    low: float
    high: float
    samples: bool = False
    step: int = 0

    def setting(self, x: float, h: float) -> float:
        """The setting at x of the unit interval, for a record sampled every h [s]."""
        value: float = self.low * (self.high / self.low) ** min(max(x, 0.0), 1.0)
        if self.samples:
            value /= h
        if self.step:
            value = 1 + self.step * max(round((value - 1) / self.step), 1)
        return value
