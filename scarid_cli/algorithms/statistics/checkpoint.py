"""The state of an estimation, which can be saved and continued with another log."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from scarid_cli.algorithms.regression.counting import LeftOut
from scarid_cli.algorithms.regression.rows import thinning
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.subsample import MOST_HELD, Subsample


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
    def at_start(
        cls, state: Any, h: float, *, holds: bool = False, thins: bool = False
    ) -> Checkpoint:
        """The checkpoint before the first sample of a record sampled every h [s].

        `holds`: the estimation keeps rows of the whole record in memory; all, unless it `thins`
        them where they are many.
        """
        if holds:
            held = Subsample(
                samples=MOST_HELD,
                numbers=MOST_HELD,
                thinnest=thinning(h) if thins else 1,
                covers=True,
            )
            return cls(state, held, None)
        return cls(state, Subsample(thinnest=thinning(h)), Blocks.every(h))
