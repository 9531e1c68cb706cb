"""Judges of the settings of a differentiator, from the data alone, without the truth.

The likelihood judges the Kalman methods by their innovations. The smoother judges by the distance
to a Kalman smoother that has tuned itself to the same positions: it also sees the samples after a
row, and is several times nearer to the truth than any causal method. Where the bandwidth has been
chosen already, the smoother is the one with this bandwidth.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.likelihood import likelihood_of_all
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.tuning.search import Judge
from scarid_cli.arrays import Array

SKIPPED_START = 1.0  # seconds at the start, where a method may still be on its way


def negative_log_likelihood(q: Array, h: float) -> Judge:
    """The negative logarithm of the likelihood of the innovations, per sample."""
    records = [np.ascontiguousarray(row) for row in np.atleast_2d(q)]
    return lambda method: -likelihood_of_all(method, records, h) / (len(records) * len(records[0]))


def distance_to_smoothers(q: Array, smoothers: Sequence[Any], h: float) -> Judge:
    """The geometric mean over the joints of the distances to the smoother of each.

    q: (joints, rows).
    """
    each = [distance_to_smoother(x, h, own) for x, own in zip(q, smoothers, strict=True)]
    return lambda method: float(np.exp(np.mean([np.log(judge(method)) for judge in each])))


def distance_to_smoother(q: Array, h: float, smooth_by: Any = None) -> Judge:
    """The geometric mean of the rms errors of velocity and acceleration against the smoother.

    Each error is divided by the standard deviation of the smoother's signal. The smoother is one
    that tunes itself, unless another one is given.
    """
    _, *smooth = over((smooth_by or smoother(q, h)).matched(), q, h)
    late = min(int(SKIPPED_START / h), len(q) // 5)
    inner = slice(late, len(q) - late)
    sizes = [float(np.std(x[inner])) or 1.0 for x in smooth]

    def judge(method: Any) -> float:
        with np.errstate(all="ignore"):
            estimates = over(method, q, h)
            errors = [
                np.sqrt(np.mean((x - y)[inner] ** 2)) / size
                for x, y, size in zip(estimates, smooth, sizes, strict=True)
            ]
        return float(np.sqrt(errors[0] * errors[1]))

    return judge


def smoother(q: Array, h: float) -> Any:
    """The Kalman smoother, tuned to the positions q of one joint."""
    return DIFFERENTIATORS.load("rts")().fitted(q, h)
