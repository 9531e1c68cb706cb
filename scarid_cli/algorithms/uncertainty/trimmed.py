"""Least squares from the part of a record that the model explains best.

A contact or a push moves all estimates, and so its residual spreads over the whole record. Least
trimmed squares (Rousseeuw 1984) are the estimates that explain three quarters of the blocks best;
they are found by concentration steps (Rousseeuw and Van Driessen 2006): the blocks with the least
squares of the residual are fitted again, until they are the same.
"""

from __future__ import annotations

from itertools import compress

import numpy as np

from scarid_cli.algorithms.regression.normal_equations import solved
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.arrays import Array, Marks, median

KEPT = 0.75  # of the rows
STEPS = 20  # at most; each lowers the sum of squares


def trimmed(blocks: Blocks) -> Array:
    """The estimates (parameters) from the blocks of a record that are explained best.

    A joint counts by the inverse of its median mean square residual over the blocks. Directions
    that the blocks do not determine are 0.
    """
    products = [product[:, :-1, :-1] for product in blocks.products]
    rows = np.array([product[:, -1, -1] for product in blocks.products])
    variances = np.mean([product[:, -1, -1] for product in products], axis=0)
    kept = np.ones(len(rows), dtype=np.bool_)
    for _ in range(STEPS):
        total = np.asarray(sum(compress(products, kept)))
        weighted = np.tensordot(_inverse(variances), total, 1)
        estimates = solved(weighted[:-1, :-1], weighted[:-1, -1])
        along = np.append(estimates, -1.0)
        squares = np.array([product @ along @ along for product in products]).clip(min=0.0)
        means = squares / np.maximum(rows, 1.0)
        variances = np.array([median(x[n > 0.0]) for x, n in zip(means.T, rows.T, strict=True)])
        before, kept = kept, _least(squares @ _inverse(variances), rows.sum(axis=1))
        if np.array_equal(before, kept):
            break
    return estimates


def _inverse(variances: Array) -> Array:
    """Their inverses, 0 for a joint without rows or residual."""
    there = variances > 0.0
    return np.divide(1.0, variances, out=np.zeros_like(variances), where=there)


def _least(squares: Array, rows: Array) -> Marks:
    """The blocks with the least mean squares that have KEPT of the rows."""
    order = np.argsort(squares / np.maximum(rows, 1.0))
    kept = np.zeros(len(rows), dtype=np.bool_)
    kept[order] = np.cumsum(rows[order]) <= KEPT * rows.sum()
    return kept
