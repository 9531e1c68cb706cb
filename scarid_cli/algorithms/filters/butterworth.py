"""Butterworth low-pass as a cascade of second-order sections (paper section 3.2, data filtering).

Designed by the bilinear transform with the cut-off pre-warped, as MATLAB and scipy do. The causal
form starts at rest at the first sample, so that it makes no transient.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.choices.settings import (
    require_below_nyquist,
    require_positive,
    require_whole,
)
from scarid_cli.algorithms.filters.sections import SectionState, advanced, at_rest
from scarid_cli.algorithms.processes.process import Causal, Record, Whole
from scarid_cli.arrays import Array
from scarid_cli.errors import TooShort


@dataclass(frozen=True)
class Butterworth(Causal):
    """Low-pass of an order with -3 dB at the cut-off [Hz]."""

    cutoff: float
    order: int = 4

    def __post_init__(self) -> None:
        require_positive(self, "cutoff", "order")
        require_whole(self, "order")

    def sections(self, h: float) -> Array:
        """Rows b0, b1, b2, a1, a2, each section of unit gain at rest; h [s]."""
        require_below_nyquist(self.cutoff, h)
        w = 2.0 * np.tan(np.pi * self.cutoff * h)
        rows = [_pair(w, angle) for angle in _angles(self.order)]
        if self.order % 2:
            rows.append(_single(w))
        return np.array(rows)

    def init(self, x: float, h: float) -> SectionState:
        """At rest at x."""
        return at_rest(self.sections(h), x)

    def step(self, state: SectionState, x: Array) -> tuple[SectionState, tuple[Array, ...]]:
        """The filtered samples x, causally."""
        state, y = advanced(state, x)
        return state, (y,)


@dataclass(frozen=True)
class ZeroPhase(Whole):
    """Forwards and backwards; the record is extended oddly at both ends, as MATLAB does."""

    cutoff: float
    order: int = 4

    def __post_init__(self) -> None:
        Butterworth(self.cutoff, self.order)

    def init(self, x: float, h: float) -> Record:
        self._sections(h)
        return super().init(x, h)

    def over(self, x: Array, h: float) -> tuple[Array, ...]:
        from scipy import signal

        padding = 3 * int(self.order)
        if len(x) <= padding:
            raise TooShort(
                f"a zero-phase filter of this order needs a log of more than {padding} rows, not "
                f"{len(x)}"
            )
        sections = np.insert(self._sections(h), 3, 1.0, axis=1)
        return (signal.sosfiltfilt(sections, x, padtype="odd", padlen=padding),)

    def _sections(self, h: float) -> Array:
        return Butterworth(self.cutoff, int(self.order)).sections(h)


def _angles(order: int) -> Array:
    """Angles of the upper left half-plane poles from the negative real axis."""
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
