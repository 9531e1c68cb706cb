"""Cascades of second-order sections with their state."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import sos


@dataclass(frozen=True)
class SectionState:
    """Two numbers per section, and the sections: rows b0, b1, b2, a1, a2."""

    values: Array
    sections: Array


def at_rest(sections: Array, x: float) -> SectionState:
    """Sections of unit gain at rest that have seen x for ever."""
    b1, b2, a1, a2 = sections[:, 1], sections[:, 2], sections[:, 3], sections[:, 4]
    second = (b2 - a2) * x
    return SectionState(np.column_stack(((b1 - a1) * x + second, second)), sections)


def advanced(state: SectionState, x: Array) -> tuple[SectionState, Array]:
    """The state after the samples x, and the filtered samples."""
    values = state.values.copy()
    y = np.empty_like(x)
    sos.filtered(x, y, values, state.sections)
    return replace(state, values=values), y
