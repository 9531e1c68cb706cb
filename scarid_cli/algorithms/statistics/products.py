"""Least squares with further columns beside W, and how far those move the estimates.

From the products of the rows in each block, the fit with any of the columns follows, and so do the
fits without one block after another, which give the error of each difference between two fits.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scarid_cli.arrays import Array, Numbers

SINGULAR = 1e12  # condition number, of columns of unit length, above which a fit is refused
NEW = 1e-6  # share of a column that must not be a combination of the others


@dataclass(frozen=True)
class Solved:
    """The estimates of all columns (columns), and those without each block (blocks, columns)."""

    whole: Array
    without: Array

    @property
    def deviations(self) -> Array:
        """How far the estimates move when each block is left out (blocks, columns)."""
        return self.without - self.whole


@dataclass(frozen=True)
class Products:
    """A'A of each block (blocks, columns + 1, columns + 1), with A = [W, further columns, y].

    The first `parameters` columns are those of W.
    """

    blocks: Array
    parameters: int

    @classmethod
    def of(cls, A: Array, block: Numbers, count: int, parameters: int) -> Products:
        """From rows A (samples, joints, columns + 1), scaled, in the blocks of these numbers."""
        edges = np.searchsorted(block, np.arange(count + 1))
        parts = (A[a:b].reshape(-1, A.shape[2]) for a, b in pairwise(edges.tolist()))
        return cls(np.array([part.T @ part for part in parts]), parameters)

    def independent(self, columns: list[int]) -> list[int]:
        """Those of the further columns that are no combination of W and of those before them."""
        total = self.blocks.sum(axis=0)
        kept = list(range(self.parameters))
        for i in columns:
            size = total[i, i]
            with_kept = total[kept, i]
            explained = np.linalg.lstsq(total[np.ix_(kept, kept)], with_kept, rcond=1e-14)[0]
            if size > 0.0 and size - with_kept @ explained > NEW * size:
                kept.append(i)
        return kept[self.parameters :]

    def solved(self, further: list[int]) -> Solved | None:
        """The fit of W and of these further columns; None if they are not determined."""
        columns = [*range(self.parameters), *further, -1]
        blocks = self.blocks[:, columns][:, :, columns]
        total = blocks.sum(axis=0)
        size = np.sqrt(np.diag(total)[:-1])
        if not np.all(size > 0.0):
            return None
        scale = np.append(1.0 / size, 1.0)
        scaled = total * scale[:, None] * scale
        if not np.linalg.cond(scaled[:-1, :-1]) < SINGULAR:
            return None
        rest = scaled - blocks * scale[:, None] * scale
        try:
            whole = np.linalg.solve(scaled[:-1, :-1], scaled[:-1, -1])
            without = np.linalg.solve(rest[:, :-1, :-1], rest[:, :-1, -1:])[:, :, 0]
        except np.linalg.LinAlgError:
            return None
        return Solved(whole / size, without / size)


def jackknifed(deviations: Array) -> Array:
    """The standard errors (columns) of estimates that move so far without each block."""
    blocks = len(deviations)
    return np.asarray(np.sqrt((blocks - 1) / blocks * np.sum(deviations**2, axis=0)))
