"""What the rows of each joint say, apart from those of the others: the products that gains need.

A torque constant scales the rows of one joint. Its gain can therefore be estimated from W'W, W'y
and y'y of each joint, without the rows themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array

NEW = 1e-9  # share of a nuisance column that must not be a combination of those before it


@dataclass(frozen=True)
class JointProducts:
    """A'A of each joint (joints, parameters + 1, parameters + 1), with A = [W, y], of one log.

    The rows are weighted, and whitened in time if the estimator does so. `counts` (joints) are
    their numbers, and `inflation` is by how much larger the variances of the estimates are than
    those for white residuals.
    """

    values: Array
    counts: Array
    inflation: float

    @property
    def strongest(self) -> int:
        """The joint (from 0) with the largest torque of parameters that it shares with others."""
        G, c = self.values[:, :-1, :-1], self.values[:, :-1, -1]
        theta = np.linalg.lstsq(G.sum(axis=0), c.sum(axis=0), rcond=None)[0]
        shared = np.count_nonzero(np.diagonal(G, axis1=1, axis2=2), axis=0) > 1
        theta = theta * shared
        return int(np.argmax(np.einsum("i,jik,k->j", theta, G, theta)))

    @classmethod
    def of(
        cls, total: Array, own: int, ignored: Sequence[int], counts: Array, inflation: float
    ) -> JointProducts:
        """From the products of [W, y, 1] of each joint (joints, columns + 2, columns + 2).

        The first `own` columns are kept. The others are fitted to each joint by itself, but for
        those that are `ignored`.
        """
        columns = total.shape[1] - 2
        rest = [k for k in range(own, columns) if k not in ignored]
        kept = [*range(own), columns]
        values = np.array([_without(joint, rest)[np.ix_(kept, kept)] for joint in total])
        return cls(values, counts, inflation)


def _without(products: Array, columns: Sequence[int]) -> Array:
    """The products of what a fit of these columns leaves of all."""
    left, size = products.copy(), np.diag(products)
    for k in columns:
        if left[k, k] > NEW * size[k]:
            left = left - np.outer(left[:, k], left[k]) / left[k, k]
    return left
