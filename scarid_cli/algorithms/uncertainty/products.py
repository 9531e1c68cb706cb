"""Least squares with further columns beside W, and how far those move the estimates.

From the products of the rows in each block, the fit with any of the columns follows, and so do the
fits without one block after another, which give the error of each difference between two fits. The
columns of W are eliminated once for all fits (the Schur complement), so that each further fit costs
no more than its own columns.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import chain

import numpy as np

from scarid_cli.arrays import Array

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
class Eliminated:
    """What is left of the products when the columns of W are eliminated, with unit columns.

    The first entry is that of all blocks, the others are without one block after another. `fits`
    (blocks + 1, parameters, further + 1) are the fits of the further columns and of y by W, and
    `rest` (blocks + 1, further + 1, further + 1) the products of their residuals.
    """

    fits: Array
    rest: Array


@dataclass(frozen=True)
class Products:
    """A'A of each block (blocks, columns + 1, columns + 1), with A = [W, further columns, y].

    The first `parameters` columns are those of W.
    """

    blocks: Array
    parameters: int

    @classmethod
    def of(cls, parts: Iterable[Array], parameters: int) -> Products:
        """From the rows A (samples, joints, columns + 1) of each block, scaled."""
        flat = (part.reshape(-1, part.shape[2]) for part in parts)
        return cls(np.array([rows.T @ rows for rows in flat]), parameters)

    @cached_property
    def scale(self) -> Array:
        """What gives the columns unit length (columns + 1); 0 for a column of zeros, 1 for y."""
        size = np.sqrt(np.diag(self.blocks.sum(axis=0))[:-1])
        return np.append(np.where(size > 0.0, 1.0 / np.where(size > 0.0, size, 1.0), 0.0), 1.0)

    @cached_property
    def eliminated(self) -> Eliminated | None:
        """The products without W; None if the rows do not determine its parameters."""
        p, scales = self.parameters, self.scale[:, None] * self.scale
        total = self.blocks.sum(axis=0) * scales
        if not self.scale[:p].all() or not np.linalg.cond(total[:p, :p]) < SINGULAR:
            return None
        try:  # one block after another, for the systems of all are large
            systems = chain([total], (total - own * scales for own in self.blocks))
            fits, rest = zip(*(_without_first(system, p) for system in systems), strict=True)
        except np.linalg.LinAlgError:
            return None
        return Eliminated(np.array(fits), np.array(rest))

    @cached_property
    def spread(self) -> Array:
        """Of how many blocks the power of each column is, effectively (columns + 1)."""
        power = np.diagonal(self.blocks, axis1=1, axis2=2)
        with np.errstate(divide="ignore", invalid="ignore"):
            effective = power.sum(axis=0) ** 2 / np.sum(power**2, axis=0)
        return np.asarray(np.nan_to_num(effective))

    def independent(self, columns: list[int]) -> list[int]:
        """Those of the further columns that are no combination of W and of those before them."""
        if self.eliminated is None:
            return []
        rest, kept = self.eliminated.rest[0].copy(), []
        for column in columns:
            i = column - self.parameters
            if rest[i, i] > NEW:
                kept.append(column)
                rest -= np.outer(rest[:, i], rest[i]) / rest[i, i]
        return kept

    def left_of(self, column: int) -> float:
        """The square of what W leaves of a further column; 0 if W is not determined."""
        if self.eliminated is None or not self.scale[column]:
            return 0.0
        i = column - self.parameters
        return float(self.eliminated.rest[0][i, i] / self.scale[column] ** 2)

    def solved(self, further: list[int]) -> Solved | None:
        """The fit of W and of these independent columns; None if they are not determined."""
        if self.eliminated is None:
            return None
        fits, rest = self.eliminated.fits, self.eliminated.rest
        chosen = [column - self.parameters for column in further]
        try:
            own = np.linalg.solve(rest[:, chosen][:, :, chosen], rest[:, chosen, -1:])
        except np.linalg.LinAlgError:
            return None
        of_W = fits[:, :, -1:] - fits[:, :, chosen] @ own
        found = np.concatenate((of_W, own), axis=1)[:, :, 0]
        found *= self.scale[[*range(self.parameters), *further]]
        return Solved(found[0], found[1:])


def _without_first(system: Array, p: int) -> tuple[Array, Array]:
    """The fits of the further columns by the first p, and the products of their residuals."""
    fits = np.asarray(np.linalg.solve(system[:p, :p], system[:p, p:]), dtype=np.float64)
    return fits, system[p:, p:] - system[p:, :p] @ fits


def jackknifed(deviations: Array) -> Array:
    """The standard errors (columns) of estimates that move so far without each block."""
    blocks = len(deviations)
    return np.asarray(np.sqrt((blocks - 1) / blocks * np.sum(deviations**2, axis=0)))
