"""The normal equations of a record in blocks of time, for each joint.

From these blocks the robust errors (`jackknife.py`) and the residuals of a record of any length are
computed without holding its rows in memory.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.arrays import Array

FINEST_BLOCK = 0.1  # s, before any blocks are merged
SHORTEST_BLOCK = 16  # samples
MOST_BLOCKS = 128  # above this number, neighbouring blocks are merged in pairs
MOST_HELD = 1024  # samples that are held until their products are computed


@dataclass(frozen=True)
class Blocks:
    """The products of the rows in consecutive blocks of a record, each `length` samples long.

    Block k consists of the samples from k `length` to (k + 1) `length` - 1; `numbers` lists the k
    of the blocks that have samples. `products` (blocks, joints, parameters + 2, parameters + 2) are
    A'A of the rows of each block, where A = [W, y, 1]. Rows are multiplied a fixed number of
    samples (`unit`) at a time, so that the result is the same to the last bit for any batches;
    `held` are the rows of a unit that is not yet complete.
    """

    length: int
    numbers: tuple[int, ...] = ()
    products: tuple[Array, ...] = ()
    held: tuple[Rows, ...] = ()

    @classmethod
    def every(cls, h: float) -> Blocks:
        """No blocks yet, for a record sampled every h [s]."""
        return cls(max(SHORTEST_BLOCK, round(FINEST_BLOCK / h)) if h > 0.0 else SHORTEST_BLOCK)

    @property
    def unit(self) -> int:
        """The number of samples that are multiplied at once: a block, or what may be held of it."""
        return min(self.length, MOST_HELD)

    def add(self, rows: Rows) -> Blocks:
        """The blocks after the next samples of the record."""
        blocks, start = self, 0
        while start < rows.samples:
            blocks = blocks._before_sample(int(rows.at[start]))
            end = (int(rows.at[start]) // blocks.unit + 1) * blocks.unit
            stop = start + int(np.searchsorted(rows.at[start:], end))
            blocks = replace(blocks, held=(*blocks.held, rows.part(slice(start, stop))))
            start = stop
        return blocks

    def _before_sample(self, at: int) -> Blocks:
        """The blocks ready for sample `at`: rows of an earlier unit are no longer held."""
        same = self.held and int(self.held[-1].at[-1]) // self.unit == at // self.unit
        return self if same else self.whole()

    def whole(self) -> Blocks:
        """The blocks with the held rows included."""
        if not self.held:
            return self
        rows = joined(self.held)
        number = int(rows.at[0]) // self.length
        mine = _products(rows)
        numbers, products = list(self.numbers), list(self.products)
        if numbers and numbers[-1] == number:
            products[-1] = products[-1] + mine
        else:
            numbers.append(number)
            products.append(mine)
        counted = replace(self, numbers=tuple(numbers), products=tuple(products), held=())
        return counted if len(numbers) <= MOST_BLOCKS else _merged_in_pairs(counted)

    @property
    def total(self) -> Array:
        """The products of all rows (joints, parameters + 2, parameters + 2)."""
        return np.asarray(sum(self.products), dtype=np.float64)  # without a copy of them all

    def columns(self, kept: list[int]) -> Blocks:
        """The blocks of a regression with only these columns of W."""
        chosen = np.array([*kept, -2, -1])
        products = tuple(p[:, chosen[:, None], chosen] for p in self.products)
        return replace(self, products=products)

    def faded(self, factor: float) -> Blocks:
        """The blocks as an estimator weights them that forgets by this factor per sample."""
        ages = [self.length * (self.numbers[-1] - number) for number in self.numbers]
        products = zip(ages, self.products, strict=True)
        return replace(self, products=tuple(factor**age * p for age, p in products))

    def grouped(self, count: int) -> list[Array]:
        """The products of the record divided into at most `count` parts of equal length."""
        first, last = self.numbers[0], self.numbers[-1] + 1
        parts = ((number - first) * count // (last - first) for number in self.numbers)
        return list(_summed(parts, self.products).values())


def _merged_in_pairs(blocks: Blocks) -> Blocks:
    """Blocks of twice the length, each the sum of two neighbours."""
    merged = _summed((number // 2 for number in blocks.numbers), blocks.products)
    numbers, products = tuple(merged), tuple(merged.values())
    return replace(blocks, length=2 * blocks.length, numbers=numbers, products=products)


def _summed(keys: Iterable[int], products: Iterable[Array]) -> dict[int, Array]:
    """The sums of the products that have the same key."""
    sums: dict[int, Array] = {}
    for key, product in zip(keys, products, strict=True):
        sums[key] = sums[key] + product if key in sums else product
    return sums


def _products(rows: Rows) -> Array:
    """A'A of each joint (joints, parameters + 2, parameters + 2) for A = [W, y, 1], scaled."""
    samples, joints, parameters = rows.W.shape
    found = np.empty((joints, parameters + 2, parameters + 2))
    for j in range(joints):
        both = np.ones((samples, parameters + 2))
        both[:, :-2] = rows.W[:, j]
        both[:, -2] = rows.y[:, j]
        both *= rows.scales[:, j : j + 1]
        found[j] = both.T @ both
    return found
