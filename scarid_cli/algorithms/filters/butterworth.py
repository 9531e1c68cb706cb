"""Butterworth low-pass as a cascade of second-order sections (section 3.2 of the paper).

The filter is designed by the bilinear transform with pre-warped cutoff, as in MATLAB and scipy. The
causal form starts at rest at the first sample, so that it makes no transient on a constant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.choices.settings import (
    Validated,
    require_below_nyquist,
    require_positive,
)
from scarid_cli.algorithms.filters.sections import SectionFilter
from scarid_cli.algorithms.processes.process import Samples, WholeRecord
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort, UsageFault

LOWEST = 1e-6  # cutoff, of the rate: below, rounding takes the place of the poles


@dataclass(frozen=True)
class Butterworth(Validated, SectionFilter):
    """The causal low-pass of an order, with -3 dB at the cutoff [Hz]."""

    cutoff: float
    order: int = 4

    def check(self) -> None:
        require_positive(self, "cutoff", "order")

    def sections(self, h: float) -> Array:
        require_below_nyquist(self.cutoff, h)
        if self.cutoff * h < LOWEST:
            raise UsageFault(
                f"cutoff {self.cutoff:g} Hz is too low for a rate of {1.0 / h:g} Hz: give at least "
                f"{LOWEST / h:.3g} Hz"
            )
        w = 2.0 * np.tan(np.pi * self.cutoff * h)
        rows = [_pair(w, angle) for angle in _angles(self.order)]
        if self.order % 2:
            rows.append(_single(w))
        return np.array(rows)


@dataclass(frozen=True)
class ZeroPhase(Validated, WholeRecord):
    """The low-pass run forwards and backwards over the record.

    The record is extended oddly at both ends by three times the order, as MATLAB does.
    """

    cutoff: float
    order: int = 4

    def check(self) -> None:
        Butterworth(self.cutoff, self.order)

    def init(self, x: float, h: float) -> Samples:
        self._sections(h)
        return super().init(x, h)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        from scipy import signal

        padding = 3 * self.order
        if len(x) <= padding:
            raise TooShort(
                f"a zero-phase filter of order {self.order} needs a log of more than {padding} "
                f"rows, not {len(x)}"
            )
        sections = np.insert(self._sections(h), 3, 1.0, axis=1)
        return (signal.sosfiltfilt(sections, x, padtype="odd", padlen=padding),)

    def _sections(self, h: float) -> Array:
        return Butterworth(self.cutoff, self.order).sections(h)


def _angles(order: int) -> Array:
    """The angles of the poles in the upper left half-plane, from the negative real axis [rad]."""
    angles: Array = np.pi * (2 * np.arange(1, order // 2 + 1) + order % 2 - 1) / (2 * order)
    return angles


def _pair(w: float, angle: float) -> list[float]:
    # s^2 + 2 w cos(angle) s + w^2 with s = 2 (z - 1) / (z + 1)
    damping = 4.0 * w * np.cos(angle)
    a0 = 4.0 + damping + w * w
    gain = w * w / a0
    return [gain, 2.0 * gain, gain, (2.0 * w * w - 8.0) / a0, (4.0 - damping + w * w) / a0]


def _single(w: float) -> list[float]:
    gain = w / (2.0 + w)
    return [gain, gain, 0.0, (w - 2.0) / (2.0 + w), 0.0]
