"""What a log says about the parameters of a robot, and about all else that may have changed.

Beside the columns of W there are columns for what the parameters cannot express (columns.py). Two
logs are compared through their information matrices and scores over all of these columns.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.sensitivities import Sensitivities, zero_columns
from scarid_cli.algorithms.changes.columns import TILTS, Columns
from scarid_cli.algorithms.regression.normal_equations import inverse, roots, solved
from scarid_cli.algorithms.regression.rows import Rows, curvature, delay_column
from scarid_cli.algorithms.uncertainty.jackknife import block_numbers
from scarid_cli.arrays import Array, Numbers

REFITS = 3  # times that the joints are weighted by their residuals
LEAST = 1e-9  # of the rms torque of a joint: a smaller residual is rounding
SPANNED = 1e-9  # of a column: less is what rounding leaves of it
TINY = 1e-30  # the least variance, of a joint without torques
MOST_LEVERAGE = 0.9  # of a block that counts in full


@dataclass(frozen=True)
class LogEvidence:
    """The information of a log about all columns, at given parameters.

    `information` (columns, columns) is W'W with joints weighted by the inverse variances of their
    residuals, which account for autocorrelation; `score` (columns) is W' times the residual,
    weighted alike. `deviations` (joints) are the standard deviations of the residual after all
    columns in question have been fitted, and `scores` (blocks, columns) those of blocks of
    half a second with this residual. `biases` (alternatives, columns) are how far what the model
    may lack moves the estimates beyond noise, if this is known.
    """

    information: Array
    score: Array
    deviations: Array
    scores: Array
    biases: Array | None = None

    @property
    def blocks(self) -> int:
        """The number of blocks with samples."""
        return len(self.scores)

    @property
    def columns(self) -> Columns:
        return Columns.among(len(self.score), len(self.deviations))

    def about(self, further: Sequence[int]) -> LogEvidence:
        """The evidence about the usual columns and those in `further` places, all others known."""
        rest = [k for k in range(self.columns.usual, len(self.score)) if k not in further]
        information, score, scores = (x.copy() for x in (self.information, self.score, self.scores))
        information[rest] = information[:, rest] = score[rest] = scores[:, rest] = 0.0
        return replace(self, information=information, score=score, scores=scores)


@dataclass(frozen=True)
class Products:
    """The sums from which the evidence of a log is computed, at given parameters.

    `values` (joints, blocks, columns + 1, columns + 1) are A'A of each joint and block of half a
    second, where A = [all columns, residual]. `counts` (joints) are the rows that count, and
    `powers` (joints) their mean square torques [(N m or N)2].
    """

    values: Array
    counts: Numbers
    powers: Array

    @cached_property
    def usual(self) -> LogEvidence:
        """The evidence with the residual after the usual columns."""
        return self.evidence(())

    @classmethod
    def of(
        cls, rows: Rows, theta: Array, delay: float = 0.0, model: Model | None = None
    ) -> Products:
        """Those of the rows of a log, at parameters and a delay [s] of the torques.

        Columns of W beyond those of `theta`, such as the ringing of friction, are fitted to each
        log and left out of the comparison. Without the `model` of the rows there is nothing about
        the zeros of the joints and the tilt of the base.
        """
        p = len(theta)
        nuisances = rows.W[:, :, p:]
        rows = replace(rows, W=rows.W[:, :, :p])
        counts = np.maximum(np.count_nonzero(rows.scales, axis=0), 1)
        powers = np.sum((rows.y * (rows.scales > 0.0)) ** 2, axis=0) / counts
        further = _further(rows, theta, model)
        return cls(_products(rows, theta, delay, further, nuisances), counts, powers)

    def evidence(self, further: Sequence[int]) -> LogEvidence:
        """What the log says about all columns.

        The residual is that after the usual ones and those in `further` places have been fitted.
        """
        columns = self.values.shape[2] - 1
        first = [*range(Columns.among(columns, len(self.values)).usual), *further]
        sums, chosen = self.values.sum(axis=1), [*first, columns]
        whole = sums[:, chosen][:, :, chosen]
        least = LEAST**2 * self.powers + TINY
        variances = np.maximum(whole[:, -1, -1] / self.counts, least)
        for _ in range(REFITS):
            weighted = np.tensordot(1.0 / variances, whole, 1)
            along = np.append(-solved(weighted[:-1, :-1], weighted[:-1, -1]), 1.0)
            squares = np.einsum("i,jik,k->j", along, whole, along)
            variances = np.maximum(squares / self.counts, least)
        spread = np.zeros(columns + 1)
        spread[chosen] = along
        scores = self.values[:, :, :-1] @ spread
        total = np.tensordot(1.0 / variances, whole[:, :-1, :-1], 1)
        grams, inflations = np.zeros((self.values.shape[1], *total.shape)), []
        for j, variance in enumerate(variances.tolist()):  # one joint at a time, for they are large
            own = self.values[j][:, first][:, :, first] / variance
            inflations.append(_inflation(scores[j][:, first], own, variance, total))
            grams += own
        weights = 1.0 / (variances * inflations)
        scores[:, :, first] = _without_leverage(scores[:, :, first], grams)
        total = np.tensordot(weights, sums, 1)
        return LogEvidence(
            information=total[:-1, :-1],
            score=total[:-1, -1],
            deviations=np.sqrt(variances),
            scores=np.tensordot(weights, scores, 1),
        )

    def torque_shares(self, squares: Array) -> Array:
        """The rms of what a change of all columns does to the torque of each joint (joints).

        It is relative to the rms of the torque that the parameters predict. `squares` (columns,
        columns) are the products of the changes of two columns, or their covariances.
        """
        sums = self.values.sum(axis=1)[:, :-1, :-1]
        changes = np.einsum("ik,jki->j", squares, sums).clip(min=0.0)
        predicted = Columns.among(len(squares), len(sums)).motors
        torques = sums[range(len(sums)), predicted, predicted]
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.sqrt(changes / torques))


def _without_leverage(scores: Array, grams: Array) -> Array:
    """The scores of each joint and block, as large as if the fit had not made them small.

    Each is divided by the root of one minus the leverage of its block ("CR2", unbiased for white
    noise; Bell and McCaffrey 2002), which counts as at most MOST_LEVERAGE. `grams` (blocks,
    columns, columns) are W'W of each block.
    """
    to, back = roots(grams.sum(axis=0))
    larger = np.empty_like(scores)
    for b, gram in enumerate(grams):
        leverage, along = np.linalg.eigh(to.T @ gram @ to)
        factors = 1.0 / np.sqrt(1.0 - leverage.clip(0.0, MOST_LEVERAGE)) - 1.0
        extra = scores[:, b] @ to @ along
        larger[:, b] = scores[:, b] + (extra * factors) @ along.T @ back.T
    return larger


def _inflation(scores: Array, grams: Array, variance: float, total: Array) -> float:
    """By how much autocorrelation increases the variance of the scores of a joint.

    The squares of the scores (blocks, columns) are compared with those that white noise leaves
    behind the fit of all joints: with G of a block among the `grams`, and N the `total` of all
    joints, G - G N^-1 G. So a short log, whose every block the fit follows, is not taken for a
    noisy one. The mean is over the columns, which count by their information; at least 1.
    """
    sizes = np.einsum("bkk->k", grams)
    spent = np.einsum("bik,bki->i", grams @ inverse(total), grams)
    there = sizes > 1e-12 * sizes.max()
    parts = np.divide(1.0, sizes, out=np.zeros_like(sizes), where=there)
    squares = (scores**2).sum(axis=0) / variance**2
    white = np.sum((sizes - spent) * parts)
    return max(float(np.sum(squares * parts) / max(white, TINY)), 1.0)


def _further(rows: Rows, theta: Array, model: Model | None) -> Array:
    """The change of the torques (samples, joints, columns) by all that is not always in question.

    It is that by another zero of each joint, a tilted base, and a low-pass.
    """
    joints = rows.y.shape[1]
    found = np.zeros((rows.samples, joints, joints + TILTS + 1))
    found[:, :, -1] = curvature(rows, rows.W @ theta)
    if model is None:
        return found
    found[:, :, :joints] = zero_columns(Sensitivities.of(model, theta, rows.motion[:3], orders=1))
    tilt = model.tilted(rows.motion[0], theta)
    if tilt is not None:
        found[:, :, joints:-1] = tilt
    return found


def _products(rows: Rows, theta: Array, delay: float, further: Array, nuisances: Array) -> Array:
    """A'A of each joint and block, where A = [all columns, residual] without the `nuisances`."""
    predicted = rows.W @ theta
    column = delay_column(rows, predicted)
    residual = rows.y - predicted - delay * column
    joints, starts = rows.y.shape[1], _blocks(rows)
    columns = Columns(len(theta), joints)
    found = np.zeros((joints, len(starts), columns.count + 1, columns.count + 1))
    ones = np.ones(rows.samples)
    for j in range(joints):
        counted = (rows.scales[:, j : j + 1] > 0.0).astype(np.float64)
        narrow = np.column_stack(
            (rows.W[:, j], column[:, j], predicted[:, j], ones, further[:, j], residual[:, j])
        )
        own = [*range(columns.motors.start), columns.motors[j], columns.offsets[j]]
        at = np.array([*own, *range(columns.usual, columns.count + 1)])
        narrow = _without(counted * nuisances[:, j], counted * narrow)
        for b, (start, stop) in enumerate(starts):
            part = narrow[start:stop]
            found[j, b, at[:, None], at] = part.T @ part
    return found


def _without(nuisances: Array, columns: Array) -> Array:
    """What a fit of the nuisances leaves of columns, both (samples, columns).

    Of a column that they span it leaves nothing, and not what rounding does.
    """
    along = np.linalg.qr(nuisances[:, np.any(nuisances != 0.0, axis=0)])[0]
    left = columns - along @ (along.T @ columns)
    spanned = np.linalg.norm(left, axis=0) < SPANNED * np.linalg.norm(columns, axis=0)
    return np.where(spanned, 0.0, left)


def _blocks(rows: Rows) -> list[tuple[int, int]]:
    """The first sample of each block of half a second, and the one after its last."""
    block, count = block_numbers(rows.at, rows.h)
    return list(pairwise(np.searchsorted(block, np.arange(count + 1)).tolist()))
