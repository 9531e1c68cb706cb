"""The state of an estimation, which can be saved and continued with another log."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from scarid_cli.algorithms.regression.counting import LeftOut
from scarid_cli.algorithms.regression.rows import thinning
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.subsample import Subsample


@dataclass(frozen=True)
class Checkpoint:
    """The state of an estimation after some rows.

    `state` is that of the estimator. The statistics need `subsample` and, unless this holds all
    rows, `blocks`. `seen` is the number of samples so far, including those that were left out;
    `left_out` counts these.
    """

    state: Any
    subsample: Subsample
    blocks: Blocks | None
    seen: int = 0
    left_out: LeftOut = field(default_factory=LeftOut)

    @classmethod
    def at_start(cls, state: Any, h: float, held: Subsample | None = None) -> Checkpoint:
        """The checkpoint before the first sample of a record sampled every h [s].

        `held` is what an estimation begins with that keeps rows of the whole record in memory.
        """
        if held:
            return cls(state, held, None)
        return cls(state, Subsample(thinnest=thinning(h)), Blocks.every(h))
