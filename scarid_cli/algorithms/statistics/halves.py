"""Whether the two halves of a record have the same parameters, or a payload was picked up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.statistics.jackknife import quantile
from scarid_cli.algorithms.statistics.products import Products, jackknifed
from scarid_cli.arrays import Array, Marks

CERTAIN = 1e-4  # probability of calling a record changed that is not


@dataclass(frozen=True)
class Halves:
    """The estimates (own) of the first and of the second half, each of so many `blocks`.

    `errors` (own) are those of their difference.
    """

    first: Array
    second: Array
    errors: Array
    blocks: int

    def differ(self, of: Marks) -> Marks:
        """Which of these estimates (own) differ by more than noise explains."""
        point = quantile(1.0 - 0.5 * CERTAIN / max(int(np.count_nonzero(of)), 1), self.blocks - 1)
        return np.asarray(of & (np.abs(self.second - self.first) > point * self.errors))


def halves(products: Products, longer: Array, own: int) -> Halves | None:
    """From the products of the blocks of a record; None if a half does not determine its estimates.

    longer (columns): how many times the errors exceed those of blocks.
    """
    columns = [*range(products.parameters), products.blocks.shape[1] - 1]
    blocks = products.blocks[:, columns][:, :, columns]
    count = len(blocks) // 2
    first, second = (
        Products(half, products.parameters).solved([]) for half in (blocks[:count], blocks[-count:])
    )
    if count < 2 or first is None or second is None:
        return None
    errors = longer * np.hypot(jackknifed(first.deviations), jackknifed(second.deviations))
    return Halves(first.whole[:own], second.whole[:own], errors[:own], count)
