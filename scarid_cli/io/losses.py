"""What a live source has lost, told by the times of its rows alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from statistics import median

GAP = 1.5  # median periods; a longer step of the time is a gap
BLOCK = 1000  # steps of which the median is taken
FEW = 10  # steps whose median says little: that of the block before is taken
# Packets overtake each other within milliseconds: a row that lies farther behind [s] is of a source
# that was started again.
BEHIND = 1.0


@dataclass
class Losses:
    """The gaps of a time column, and its rows out of order; memory does not grow."""

    lost: int = 0
    gaps: int = 0
    longest: float = 0.0  # s
    out_of_order: int = 0
    repeated: int = 0
    restarts: int = 0
    _latest: float | None = None
    _period: float = 0.0
    _steps: list[float] = field(default_factory=list)

    def row(self, t: float, *, first: bool = False) -> None:
        """A row of this time [s]; the `first` one of a connection may begin again."""
        if self._latest is None:
            self._latest = t
            return
        step = t - self._latest
        if step > 0.0:
            self._steps.append(step)
        elif first or step < -BEHIND:
            self.restarts += 1
        else:
            self.repeated += step == 0.0
            self.out_of_order += step != 0.0
            return
        self._latest = t
        if len(self._steps) == BLOCK:
            self.judge()

    def judge(self) -> None:
        """Count the gaps among the steps so far."""
        if len(self._steps) >= FEW or not self._period:
            self._period = median(self._steps) if self._steps else 0.0
        for step in self._steps:
            if step > GAP * self._period:
                self.gaps += 1
                self.lost += round(step / self._period) - 1
                self.longest = max(self.longest, step)
        self._steps.clear()

    def told(self) -> str:
        """What is said at the end."""
        self.judge()
        late = min(self.out_of_order, self.lost)  # rows that overtook each other left gaps
        parts = []
        if self.gaps:
            text = f"about {self.lost - late:,} lost in {_many(self.gaps, 'gap')} of t"
            parts.append(f"{text} (the longest {self.longest:.3g} s)")
        if self.out_of_order:
            parts.append(f"{self.out_of_order:,} out of order")
        if self.repeated:
            parts.append(f"{self.repeated:,} repeated")
        if self.restarts:
            parts.append(f"the time began again {_many(self.restarts, 'time')}")
        return "; ".join(parts) or "none lost, repeated or out of order"


@dataclass
class Parts:
    """The numbers of the parts of a record between gaps of the time, from 0, row by row.

    Where the time begins again, it is counted on: rows then come so much `later`.
    """

    number: int = 0
    later: float = 0.0  # s
    _latest: float | None = None
    _steps: list[float] = field(default_factory=list)

    def of(self, t: float, *, again: bool = False) -> int:
        """The part of a row of this time [s], with which the time may begin `again`."""
        if again and self._latest is not None:
            self.later += self._latest + BEHIND - t
            self.number += 1
            self._latest = t
            return self.number
        step = 0.0 if self._latest is None else t - self._latest
        self._latest = t
        if self._steps and step > GAP * median(self._steps):
            self.number += 1
        elif step > 0.0 and len(self._steps) < FEW:
            self._steps.append(step)
        return self.number


def _many(count: int, what: str) -> str:
    return f"{count:,} {what}{'s' if count > 1 else ''}"
