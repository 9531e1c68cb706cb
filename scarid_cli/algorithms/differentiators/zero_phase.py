"""Zero-phase Butterworth filter, then central differences: the field's standard offline.

Whole record. scipy.signal.sosfiltfilt with MATLAB's padding. No delay. Matched (--match, exact):
position and torque pass the filter. Rule: the cutoff at five to ten times the motion's bandwidth on
a clean log; `scarid tune` finds it.
cutoff = 8 [Hz]: -3 dB each way.
order = 4: of the filter each way.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.filters.butterworth import ZeroPhase
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(ZeroPhase):
    cutoff: float = 8.0
    order: int = 4

    TUNED: ClassVar = {"cutoff": Range(0.5, 50.0)}

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        return self.matched().over(x, h)[1:]

    def matched(self) -> Matched:
        return Matched(self.cutoff, self.order)


@dataclass(frozen=True)
class Matched(ZeroPhase):
    """The filtered position with its derivatives."""

    @property
    def torque_filter(self) -> ZeroPhase:
        return ZeroPhase(self.cutoff, self.order)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        (q,) = super().over(x, h)
        a = np.empty_like(q)
        a[1:-1] = np.diff(np.diff(q)) / h**2
        a[0], a[-1] = a[1], a[-2]
        return q, np.gradient(q, h), a
