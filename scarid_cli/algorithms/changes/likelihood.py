"""Generalised likelihood ratios of two logs: did anything change, and what explains it?"""

from __future__ import annotations

from dataclasses import dataclass
from math import log

import numpy as np

from scarid_cli.algorithms.changes.evidence import LogEvidence
from scarid_cli.algorithms.changes.hypotheses import Hypothesis
from scarid_cli.algorithms.regression.normal_equations import inverse
from scarid_cli.algorithms.uncertainty.tails import log_tail_f
from scarid_cli.arrays import Array

JOINED = (1, 2, 4)  # blocks
RANK = 1e-9  # of the largest eigenvalue of normalised information: a direction that was not moved
ALONE = 1e-6  # of the square of a direction: what lies outside those that were moved


@dataclass(frozen=True)
class Difference:
    """The difference of two logs in all columns, with psi the parameters of all columns.

    The likelihood of a change Z a of psi, when psi itself is unknown, has the `information`
    P = N1 (N1 + N2)^+ N2 about the change, and the `gradient` P (psi2 - psi1). `scores` (blocks,
    columns) are the parts of the gradient that come from blocks of the second log with the
    residual of a fit, and `model` is their covariance without autocorrelation beyond that of
    `LogEvidence`. `freedom` is the number of degrees of freedom of the noise.
    """

    information: Array
    gradient: Array
    scores: Array
    model: Array
    freedom: int

    @classmethod
    def between(cls, first: LogEvidence, second: LogEvidence) -> Difference:
        """The difference of two logs whose scores are at the same parameters."""
        N1, N2 = first.information, second.information
        pooled = inverse(N1 + N2)
        from_second, from_first = N1 @ pooled, N2 @ pooled
        information = from_second @ N2
        return cls(
            information=0.5 * (information + information.T),
            gradient=from_second @ second.score - from_first @ first.score,
            scores=second.scores @ from_second.T,
            model=from_second @ N2 @ from_second.T,
            freedom=max(min(first.blocks, second.blocks) - 1, 1),
        )

    def allowing(self, biases: Array) -> Difference:
        """The difference if psi is also uncertain by these moves (k, columns), one error each.

        They add B'B to its covariance, so that P becomes (P^-1 + B'B)^-1 = (1 - P B' K B) P, with
        K = (1 + B P B')^-1.
        """
        along = self.information @ biases.T
        gain = np.linalg.solve(np.eye(len(biases)) + biases @ along, along.T)
        part = np.eye(len(self.gradient)) - gain.T @ biases
        information = part @ self.information
        return Difference(
            information=0.5 * (information + information.T),
            gradient=part @ self.gradient,
            scores=self.scores @ part.T,
            model=part @ self.model @ part.T,
            freedom=self.freedom,
        )


@dataclass(frozen=True)
class Test:
    """A test of changes along some directions.

    `raw`, twice the gain in log-likelihood, is chi-square with `rank` degrees of freedom times
    `excess` if nothing changed; `log_p` is the logarithm of its p-value. `amounts` (k) are the
    estimated changes and `errors` (k) theirs, infinite where only combinations of them are known.
    """

    raw: float
    excess: float
    rank: int
    log_p: float
    amounts: Array
    errors: Array

    @property
    def beyond_noise(self) -> float:
        """The part of the statistic that noise alone would not give."""
        return max(self.raw - self.rank * self.excess, 1.0)

    @classmethod
    def nothing(cls, k: int = 0) -> Test:
        """The test of no directions, or of directions that no log says anything about."""
        return cls(0.0, 1.0, 0, 0.0, np.zeros(k), np.full(k, np.inf))


def everything(difference: Difference) -> Test:
    """The test of any change whatever."""
    return along(difference, np.eye(len(difference.gradient)))


def tested(difference: Difference, chosen: list[Hypothesis]) -> Test:
    """The test of some hypotheses together."""
    return along(difference, np.column_stack([h.directions for h in chosen]))


def along(difference: Difference, Z: Array) -> Test:
    """The test of changes along the columns of Z (columns, k)."""
    information = Z.T @ difference.information @ Z
    size = np.sqrt(np.maximum(np.diag(information), 0.0))
    size[size == 0.0] = np.inf
    values, vectors = np.linalg.eigh(information / np.outer(size, size))
    kept = values > RANK * max(values[-1], 1e-300)
    root = vectors[:, kept] / size[:, None] / np.sqrt(values[kept])  # root' information root = 1
    rank = int(kept.sum())
    if not rank:
        return Test.nothing(Z.shape[1])
    excess = _excess(difference, Z @ root)
    whitened = root.T @ (Z.T @ difference.gradient)
    raw = float(whitened @ whitened)
    log_p = log_tail_f(raw / excess / rank, rank, difference.freedom)
    errors = np.sqrt(excess * np.sum(root**2, axis=1))
    errors[np.sum(vectors[:, kept] ** 2, axis=1) < 1.0 - ALONE] = np.inf
    return Test(raw, excess, rank, log_p, root @ whitened, errors)


def _excess(difference: Difference, whitening: Array) -> float:
    """Autocorrelation along some directions beyond the mean over all columns; at least 1.

    It is the greatest of those of blocks, and of blocks joined in twos and in fours: what a drift
    of seconds adds would not show in blocks of half a second.
    """
    model = float(np.trace(whitening.T @ difference.model @ whitening))
    if not model > 0.0:
        return 1.0
    along = difference.scores @ whitening
    return max(1.0, *(_scatter(along, together) / model for together in JOINED))


def _scatter(scores: Array, together: int) -> float:
    """The sum of squares of the scores of blocks, so many of them joined."""
    starts = np.arange(0, len(scores), together)
    blocks = len(starts)
    return float(np.sum(np.add.reduceat(scores, starts) ** 2)) * blocks / max(blocks - 1, 1)


def penalty(difference: Difference, rank: int) -> float:
    """What an explanation of this many amounts must gain over one without (Schwarz 1978)."""
    return rank * log(difference.freedom + 1.0)
