"""Cascades of second-order sections: recursive low-pass filters with their state."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.processes.process import Causal
from scarid_cli.arrays import Array
from scarid_cli.kernels import sos


@dataclass(frozen=True)
class SectionState:
    """Two numbers for each section, and the sections: rows b0, b1, b2, a1, a2 (a0 = 1)."""

    values: Array
    sections: Array


class SectionFilter(Causal):
    """A causal low-pass of second-order sections, at rest at the first sample."""

    @abstractmethod
    def sections(self, h: float) -> Array:
        """Rows b0, b1, b2, a1, a2 (a0 = 1), each section of unit gain at rest; h [s]."""

    def init(self, x: float, h: float) -> SectionState:
        sections = self.sections(h)
        _, b1, b2, a1, a2 = sections.T
        second = (b2 - a2) * x
        return SectionState(np.column_stack(((b1 - a1) * x + second, second)), sections)

    def step(self, state: SectionState, x: Array) -> tuple[SectionState, tuple[Array, ...]]:
        values = state.values.copy()
        y = np.empty_like(x)
        sos.filtered(x, y, values, state.sections)
        return replace(state, values=values), (y,)
