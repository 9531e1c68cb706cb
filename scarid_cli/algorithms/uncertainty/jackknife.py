"""The covariance of the estimates from a jackknife that leaves out one block of time after another.

Its standard errors also hold for autocorrelated residuals; those for white residuals do not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from statistics import NormalDist

import numpy as np

from scarid_cli.algorithms.regression.estimation import Estimation, Scores
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.arrays import Array, Numbers

BLOCK_DURATION = 0.5  # s: residuals this far apart are taken to be independent
BLOCK_COUNTS = (10, 128)  # the smallest and the largest number of blocks of a record


@dataclass(frozen=True)
class RobustCovariance:
    """The robust covariance `matrix` (parameters, parameters) of the estimates.

    `blocks` is the number of blocks that it comes from; too few of them leave nan. `effective` is
    the number of blocks of equal weight that would be as many, where old blocks are forgotten.
    """

    matrix: Array
    blocks: int
    effective: float

    @property
    def errors(self) -> Array:
        """Standard errors (parameters) that are robust to autocorrelated residuals."""
        return np.asarray(np.sqrt(np.diag(self.matrix)), dtype=np.float64)

    def part(self, own: int) -> RobustCovariance:
        """The covariance of the first `own` estimates."""
        return replace(self, matrix=self.matrix[:own, :own])


def jackknife(rows: Rows, found: Estimation) -> RobustCovariance:
    """The covariance from leaving out blocks of half a second.

    It is of first order in the scores of a block and accounts for its leverage (the "CR3" estimator
    of clustered errors; Bell and McCaffrey 2002), so an estimate that rests on a few violent moves
    gets a larger error.
    """
    return _faded(_scatter(shifts(rows, found)), rows, found)


def _faded(covariance: RobustCovariance, rows: Rows, found: Estimation) -> RobustCovariance:
    """The covariance with the effective number of blocks, (sum of w)^2 / (sum of w^2).

    w is the weight that forgetting leaves to a block.
    """
    factor = found.scores.forgetting if found.scores else 1.0
    if not factor < 1.0:
        return covariance
    length = float(rows.at[-1] - rows.at[0] + 1) / covariance.blocks
    weights = np.exp(np.log(factor) * length * np.arange(covariance.blocks))
    return replace(covariance, effective=float(weights.sum() ** 2 / (weights**2).sum()))


def jackknife_of_blocks(record: Blocks, rows: Rows, found: Estimation) -> RobustCovariance:
    """The same from the blocks of a long record, of which `rows` are a subsample.

    It holds for estimators that do no more than weight the joints.
    """
    assert found.scores is not None
    weights = np.ones(rows.y.shape[1])
    if found.scores.whitening is not None:
        weights = np.diag(found.scores.whitening) ** 2
    parts = [
        (gram, moment - gram @ found.fit.estimates)
        for gram, moment in _normal(record, rows, weights)
    ]
    return _faded(_scatter(_without_each(parts)), rows, found)


def inflation(record: Blocks, rows: Rows) -> tuple[int, Array]:
    """The number of blocks, and the ratio of robust to white standard errors (parameters).

    Both are those of least squares on all rows of the record. The ratio is nan if these do not
    determine every parameter.
    """
    parts = _normal(record, rows, np.ones(rows.y.shape[1]))
    gram, moment = (np.sum(x, axis=0) for x in zip(*parts, strict=True))
    if not regular(gram):
        return len(parts), np.full(len(gram), np.nan)
    inverse = np.linalg.inv(gram)
    theta = inverse @ moment
    robust = _scatter(_without_each([(g, m - g @ theta) for g, m in parts])).errors
    total = record.total.sum(axis=0)
    squares = max(total[-2, -2] - theta @ moment, 0.0)
    white = np.sqrt(squares / (total[-1, -1] - len(theta)) * np.diag(inverse))
    with np.errstate(divide="ignore", invalid="ignore"):
        return len(parts), np.asarray(robust / white, dtype=np.float64)


def _normal(record: Blocks, rows: Rows, weights: Array) -> list[tuple[Array, Array]]:
    """W'W and W'y of each block, with weighted joints."""
    parts = []
    for products_of_joints in record.grouped(_count((rows.at[-1] - rows.at[0]) * rows.h)):
        total = np.tensordot(weights, products_of_joints, 1)
        parts.append((total[:-2, :-2], total[:-2, -2]))
    return parts


def _scatter(moved: Array) -> RobustCovariance:
    """The jackknife covariance of estimates that move by `moved` (blocks, parameters)."""
    blocks, p = moved.shape
    if blocks < 2 or not np.isfinite(moved).all():
        return RobustCovariance(np.full((p, p), np.nan), max(blocks, 2), max(blocks, 2))
    return RobustCovariance((blocks - 1) / blocks * moved.T @ moved, blocks, blocks)


def shifts(rows: Rows, found: Estimation) -> Array:
    """How far the estimates move when each block is left out (blocks, parameters)."""
    block, count = block_numbers(rows.at, rows.h)
    edges = np.searchsorted(block, np.arange(count + 1))
    return _without_each([products(rows, found, slice(a, b)) for a, b in pairwise(edges.tolist())])


def block_numbers(at: Numbers, h: float) -> tuple[Numbers, int]:
    """The block of each sample of a record sampled every h [s], and how many blocks have samples.

    at: the numbers of the samples, in ascending order.
    """
    first, last = int(at[0]), int(at[-1]) + 1
    count = _count((last - first) * h)
    used, block = np.unique((at - first) * count // (last - first), return_inverse=True)
    return block, len(used)


def _count(duration: float) -> int:
    """The number of blocks of a record of this duration [s]."""
    return int(np.clip(round(duration / BLOCK_DURATION), *BLOCK_COUNTS))


def _without_each(parts: list[tuple[Array, Array]]) -> Array:
    """How far the estimates move when each part, given by its Z'W and Z'rho, is left out."""
    p = len(parts[0][1])
    total = sum((gram for gram, _ in parts), np.zeros((p, p)))
    moved = np.full((len(parts), p), np.inf)
    for i, (gram, score) in enumerate(parts):
        if regular(total - gram):
            moved[i] = np.linalg.solve(total - gram, score)
    return moved


def regular(gram: Array) -> bool:
    """Whether a Gram matrix is well conditioned once its columns have unit length."""
    size = np.sqrt(np.abs(np.diag(gram)))
    if not np.all(size > 0.0):
        return False
    return bool(np.linalg.cond(gram / np.outer(size, size)) < 1e14)


def products(rows: Rows, found: Estimation, chosen: slice) -> tuple[Array, Array]:
    """Z'W and Z'rho of some samples after whitening; Z is W unless the fit has instruments."""
    scores = found.scores
    assert scores is not None
    part = rows.part(chosen)
    W, residual = _whitened(part, found.fit.estimates, scores)
    weights = np.minimum(1.0, scores.huber / np.maximum(np.abs(residual), 1e-300))
    left = W
    if scores.instruments is not None:
        left = _times(scores.instruments[chosen], part.scales, scores.whitening)
    flat = (left * weights[:, :, None]).reshape(-1, W.shape[2])
    return flat.T @ W.reshape(-1, W.shape[2]), flat.T @ residual.ravel()


def _whitened(rows: Rows, estimates: Array, scores: Scores) -> tuple[Array, Array]:
    """The regressor and the residual, both scaled and whitened as the fit did."""
    residual = rows.y - rows.W @ estimates
    scaled = _times(residual[:, :, None], rows.scales, scores.whitening)[:, :, 0]
    return _times(rows.W, rows.scales, scores.whitening), scaled


def _times(W: Array, scales: Array, whitening: Array | None) -> Array:
    """The rows of each sample, multiplied by their scales and then by the whitening matrix."""
    scaled = W * scales[:, :, None]
    if whitening is None:
        return scaled
    if np.count_nonzero(whitening - np.diag(np.diag(whitening))):
        scaled = scaled * np.all(scales > 0.0, axis=1).reshape(-1, 1, 1)
    mixed: Array = np.einsum("ij,kjp->kip", whitening, scaled)
    return mixed


def interval_quantiles(blocks: float, longer: Array) -> Array:
    """Half the widths of 95 % intervals, in errors that are `longer` times those of blocks.

    The variance of few blocks is not well known, which Student's t allows for. The errors of long
    disturbances allow for that themselves (`unknown` in autocovariance.py), so that these need no
    more than the quantile of a normal distribution.
    """
    return np.maximum(quantile(0.975, blocks - 1.0) / longer, NormalDist().inv_cdf(0.975))


def quantile(probability: float, freedom: float) -> float:
    """This quantile of Student's t (Abramowitz and Stegun 26.7.5)."""
    z, n = NormalDist().inv_cdf(probability), max(freedom, 1.0)
    return float(
        z
        + (z**3 + z) / (4.0 * n)
        + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * n**2)
        + (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / (384.0 * n**3)
    )
