"""How large residuals get: the level that they pass so and so often, for `validate --residual`.

The largest residuals of blocks of half a second follow Gumbel's distribution of extreme values
(Gumbel, Statistics of Extremes, 1958), whatever the distribution of the residuals is, if its tail
falls at least like an exponential one. Its mode and its scale are found from the mean and the mean
difference of two of them (L-moments; Hosking, J. R. Stat. Soc. B 52, 1990), so that neither a
normal distribution is assumed nor the autocorrelation of the residuals has to be known.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, log, log1p

import numpy as np

from scarid_cli.arrays import Array, Numbers

BLOCK = 0.5  # s
HOUR = 3600.0  # s
FEWEST = 10  # blocks, below which the scale is not known
EULER = 0.5772156649015329  # mean of Gumbel's distribution, in scales beyond the mode


@dataclass(frozen=True)
class Peaks:
    """The `mode` and the `scale` of the largest residual of half a second, in N m or N.

    nan if there are fewer than FEWEST blocks.
    """

    mode: float
    scale: float

    def level(self, rate: float, blocks: float) -> float:
        """The level that the residual passes in `rate` blocks of an hour [1/h].

        `blocks` is the number of blocks from which the scale is known. Of the exponential
        distribution whose scale is the mean of so many, a further one is beyond x scales with
        the probability (1 + x / blocks)^-blocks (Geisser, Predictive Inference, 1993, 2.2).
        """
        share = min(rate * BLOCK / HOUR, 0.5)
        beyond = -log(-log1p(-share))  # in scales; ln(1 / share) for a small one
        wide = blocks * (np.exp(beyond / blocks) - 1.0) if isfinite(blocks) else beyond
        return self.mode + self.scale * float(wide)


def peaks_of(residual: Array, at: Numbers, h: float) -> Peaks:
    """Those of the residual (samples) [N m or N] of a joint.

    `at` (samples) are the numbers of the samples, which are `h` [s] apart.
    """
    if not len(residual):
        return Peaks(float("nan"), float("nan"))
    _, starts = np.unique((at * h / BLOCK).astype(np.int64), return_index=True)
    largest = np.sort(np.maximum.reduceat(np.abs(residual), starts))
    count = len(largest)
    if count < FEWEST:
        return Peaks(float("nan"), float("nan"))
    mean = float(largest.mean())
    ranks = np.arange(count) / (count - 1.0)
    half_difference = float(2.0 * np.mean(ranks * largest)) - mean
    scale = half_difference / log(2.0)
    return Peaks(mean - EULER * scale, scale)
