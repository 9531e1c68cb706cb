"""A record of any length as blocks: what each tells of the parameters, joint by joint.

For the errors (`jackknife.py`) and the residuals of a record without holding its rows.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, joined
from scarid_cli.arrays import Array

FINEST = 0.1  # s: of a block in the beginning
FEWEST = 16  # samples of a block
MOST = 128  # blocks; then they are merged by twos
UNIT = 1024  # samples


@dataclass(frozen=True)
class Blocks:
    """Products of the rows of samples number k `length` to (k + 1) `length` - 1, for each k.

    `products` (blocks, joints, parameters + 2, parameters + 2) of [W, y, 1]; `numbers` are the k.
    Always a `unit` of samples is multiplied at once, so that batches do not change a bit; `held`
    are the rows of one that is not full.
    """

    length: int
    numbers: tuple[int, ...] = ()
    products: tuple[Array, ...] = ()
    held: tuple[Rows, ...] = ()

    @classmethod
    def every(cls, h: float) -> Blocks:
        """Before the first of samples that are h [s] apart."""
        return cls(max(FEWEST, round(FINEST / h)) if h > 0.0 else FEWEST)

    @property
    def unit(self) -> int:
        """Samples: a block, but no more than can be held."""
        return min(self.length, UNIT)

    def add(self, rows: Rows) -> Blocks:
        """Take in the next samples."""
        blocks, start = self, 0
        while start < rows.samples:
            blocks = blocks._begun(int(rows.at[start]))
            end = (int(rows.at[start]) // blocks.unit + 1) * blocks.unit
            stop = start + int(np.searchsorted(rows.at[start:], end))
            blocks = replace(blocks, held=(*blocks.held, rows.part(slice(start, stop))))
            start = stop
        return blocks

    def _begun(self, at: int) -> Blocks:
        """Before the sample of this number: what is held is of the same unit."""
        same = self.held and int(self.held[-1].at[-1]) // self.unit == at // self.unit
        return self if same else self.whole()

    def whole(self) -> Blocks:
        """With the rows that were held."""
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
        return counted if len(numbers) <= MOST else _halved(counted)

    @property
    def total(self) -> Array:
        """The products of all rows (joints, parameters + 2, parameters + 2)."""
        return np.asarray(np.sum(self.products, axis=0), dtype=np.float64)

    def columns(self, kept: list[int]) -> Blocks:
        """With some of the columns of W alone."""
        chosen = np.array([*kept, -2, -1])
        products = tuple(p[:, chosen[:, None], chosen] for p in self.products)
        return replace(self, products=products)

    def grouped(self, count: int) -> list[Array]:
        """The products of at most so many parts of the record, of equal length."""
        first, last = self.numbers[0], self.numbers[-1] + 1
        parts = ((number - first) * count // (last - first) for number in self.numbers)
        return list(_summed(parts, self.products).values())


def _halved(blocks: Blocks) -> Blocks:
    """Each two as one."""
    merged = _summed((number // 2 for number in blocks.numbers), blocks.products)
    numbers, products = tuple(merged), tuple(merged.values())
    return replace(blocks, length=2 * blocks.length, numbers=numbers, products=products)


def _summed(keys: Iterable[int], products: Iterable[Array]) -> dict[int, Array]:
    """The sum of the products of each key."""
    sums: dict[int, Array] = {}
    for key, product in zip(keys, products, strict=True):
        sums[key] = sums[key] + product if key in sums else product
    return sums


def _products(rows: Rows) -> Array:
    samples, joints, parameters = rows.W.shape
    found = np.empty((joints, parameters + 2, parameters + 2))
    for j in range(joints):
        both = np.ones((samples, parameters + 2))
        both[:, :-2] = rows.W[:, j]
        both[:, -2] = rows.y[:, j]
        both *= rows.scales[:, j : j + 1]
        found[j] = both.T @ both
    return found
