"""Zero-phase Butterworth filter, then central differences: the standard of the field offline.

Whole record. Butterworth (1930), run forwards and backwards by scipy.signal.sosfiltfilt with the
padding of MATLAB.
Delay: none.
Matched (exact): position and torque pass the filter.
Rule: choose the cutoff at five to ten times the bandwidth of the motion on a clean log;
`scarid tune` finds it.
cutoff = 8 [Hz]: cutoff frequency, -3 dB in each direction.
order = 4: order of the filter in each direction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.filters.butterworth import ZeroPhase
from scarid_cli.algorithms.processes.method import Matching
from scarid_cli.algorithms.processes.process import Samples
from scarid_cli.algorithms.processes.records import RecordMethod
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Differentiator(RecordMethod):
    cutoff: float = 8.0
    order: int = 4

    MATCHING = Matching.EXACT
    TUNED: ClassVar = {"cutoff": Range(0.5, 50.0)}

    @property
    def two_sided_order(self) -> int:
        return self.order

    def check(self) -> None:
        self.torque_filter()

    def init(self, x: float, h: float) -> Samples:
        return self.torque_filter().init(x, h)

    def smoothed(self, x: Array, h: float) -> tuple[Array, ...]:
        (q,) = self.torque_filter().over(x, h)
        a = np.empty_like(q)
        a[1:-1] = np.diff(np.diff(q)) / h**2
        a[0], a[-1] = a[1], a[-2]
        return q, np.gradient(q, h), a

    def torque_filter(self) -> ZeroPhase:
        return ZeroPhase(self.cutoff, self.order)
