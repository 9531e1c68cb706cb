"""Whether the parts of a record before and after some time have the same parameters.

A payload that is picked up or put down changes those of the links. The time is not known: the
record is cut at several places, and both parts are fitted by themselves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.products import Products, Solved, jackknifed
from scarid_cli.arrays import Array, Marks

CERTAIN = 1e-4  # probability of calling a record changed that is not
FEWEST = 5  # blocks of a part
MOST = 15  # places where a record is cut


@dataclass(frozen=True)
class Cut:
    """The estimates (own) of the parts `before` and `after` the block `at`.

    `errors` (own) are those of their difference; the shorter part has so many `blocks`. It is one
    of so many cuts that were `tried`.
    """

    at: int
    before: Array
    after: Array
    errors: Array
    blocks: int
    tried: int = 1

    def differ(self, of: Marks) -> Marks:
        """Which of these estimates (own) differ by more than noise explains."""
        tests = self.tried * max(int(np.count_nonzero(of)), 1)
        point = quantile(1.0 - 0.5 * CERTAIN / tests, self.blocks - 1)
        return np.asarray(of & (np.abs(self.after - self.before) > point * self.errors))


def cuts(products: Products, longer: Array, own: int) -> tuple[Cut, ...]:
    """From the products of the blocks of a record; without cuts of which a part is undetermined.

    longer (columns): how many times the errors exceed those of blocks.
    """
    count = len(products.blocks)
    least = min(FEWEST, count // 2)
    if least < 2:
        return ()
    places = np.linspace(least, count - least, min(MOST, count - 2 * least + 1)).round()
    tried = sorted({*places.astype(int).tolist(), count // 2})
    return tuple(_cuts(products, longer, own, tried))


def _cuts(products: Products, longer: Array, own: int, tried: list[int]) -> Iterator[Cut]:
    for at in tried:
        parts = products.blocks[:at], products.blocks[at:]
        # What was fitted beside the parameters may be missing in a part of the record.
        for columns in (products.parameters, own):
            before, after = (_solved(part, columns) for part in parts)
            if before and after:
                spread = np.hypot(jackknifed(before.deviations), jackknifed(after.deviations))
                errors = (longer[:columns] * spread)[:own]
                fewer = min(map(len, parts))
                yield Cut(at, before.whole[:own], after.whole[:own], errors, fewer, len(tried))
                break


def _solved(blocks: Array, columns: int) -> Solved | None:
    """The fit of the first columns to some blocks."""
    chosen = [*range(columns), blocks.shape[1] - 1]
    return Products(blocks[:, chosen][:, :, chosen], columns).solved([])
