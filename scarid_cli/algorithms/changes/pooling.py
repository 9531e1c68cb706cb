"""One identification from several: the estimates of logs, weighted by their information."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.changes.evidence import LogEvidence
from scarid_cli.algorithms.regression.normal_equations import inverse
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Pooled:
    """The estimates of some logs together.

    `theta` (parameters) and `delay` [s] maximise the product of their likelihoods; `evidence` is
    that of all logs, at these estimates.
    """

    theta: Array
    delay: float
    evidence: LogEvidence


def pooled(
    thetas: Sequence[Array], delays: Sequence[float], found: Sequence[LogEvidence]
) -> Pooled:
    """Pool the estimates of logs, and their delays [s] unless no log fitted one (all are 0).

    Normal equations add up. Each log has them at its own estimates, from where they are moved to
    the common ones. Directions that no log determines keep the values of the first log.
    """
    p, columns = len(thetas[0]), len(found[0].score)
    points = [np.concatenate((theta, [delay], np.zeros(columns - p - 1)))
              for theta, delay in zip(thetas, delays, strict=True)]  # fmt: skip
    first = points[0]
    information = np.sum([own.information for own in found], axis=0)
    score = np.sum([own.score + own.information @ (point - first)
                    for own, point in zip(found, points, strict=True)], axis=0)  # fmt: skip
    free = p + any(delays)
    step = np.zeros(columns)
    step[:free] = inverse(information[:free, :free]) @ score[:free]
    together = LogEvidence(
        information=information,
        score=score - information @ step,
        deviations=np.sqrt(np.mean([own.deviations**2 for own in found], axis=0)),
        scores=np.zeros((sum(own.blocks for own in found), columns)),
    )
    common = first + step
    return Pooled(common[:p], float(common[p]), together)
