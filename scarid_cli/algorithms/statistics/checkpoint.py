"""The state of an estimation, which can be saved and continued with another log."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.misalignment import LAG
from scarid_cli.algorithms.statistics.subsample import ALL, Subsample

ROWS_PER_LAG = 5  # at least, in the subsample of a long record, within the lag of the lag test


@dataclass(frozen=True)
class Checkpoint:
    """The state of an estimation after some rows.

    `state` is that of the estimator. The statistics need `subsample` and, unless this holds all
    rows, `blocks`. `seen` is the number of samples so far, including those that were left out.
    """

    state: Any
    subsample: Subsample
    blocks: Blocks | None
    seen: int = 0

    @classmethod
    def at_start(cls, state: Any, h: float, *, holds: bool) -> Checkpoint:
        """The checkpoint before the first sample of a record sampled every h [s].

        `holds`: the estimation keeps all rows in memory.
        """
        if holds:
            return cls(state, Subsample(samples=ALL), None)
        thinnest = int(LAG / ROWS_PER_LAG / h + 1e-9) if h > 0.0 else 1
        return cls(state, Subsample(thinnest=max(1, thinnest)), Blocks.every(h))
