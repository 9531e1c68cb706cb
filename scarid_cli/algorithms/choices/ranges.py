"""Where `scarid tune` looks for a setting."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Range:
    """Where a setting is looked for, on a logarithmic scale.

    `samples`: the range is in seconds, the setting in samples. `step`: the setting is rounded to
    1, 1 + step, 1 + 2 step, ...; 0 for any number.
    """

    low: float
    high: float
    samples: bool = False
    step: int = 0

    def setting(self, x: float, h: float) -> float:
        """From the unit interval."""
        value: float = self.low * (self.high / self.low) ** min(max(x, 0.0), 1.0)
        if self.samples:
            value /= h
        if self.step:
            value = 1 + self.step * max(round((value - 1) / self.step), 1)
        return value
