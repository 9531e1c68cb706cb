"""The fit of the time by which the torques lead the motion, as behind a delay or a low-pass."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.rows import Rows, with_delay
from scarid_cli.algorithms.regression.shifting import shifted, straightened
from scarid_cli.algorithms.statistics.curvature import log_likelihood_ratio
from scarid_cli.arrays import Array

FITS = 10  # at most, each from the estimates of the one before
FEWEST = 3  # fits, because the derivative of the torque depends on the estimates
NEAR = 0.02  # of a sample: a remaining delay up to this is left to the linear form
LONGEST = 0.5  # s, of the delay
CLEAR = 0.1  # of the log-likelihood ratio: where it is less, both forms predict the same


@dataclass(frozen=True)
class Aligned:
    """The rows with the torques shifted, and the column of the remaining delay; the estimation.

    The torques were shifted by so many samples (`shift`), and with `low_pass` straightened as well.
    `doubt` (columns) is how far the estimates may be off because the other form may be the true
    one: as a root mean square over both, which are as likely as the log says.
    """

    rows: Rows
    found: Estimation
    shift: float
    low_pass: bool = False
    doubt: Array | None = None

    @property
    def delay(self) -> float:
        """The time [s] by which the torques lead the motion."""
        return float(self.shift * self.rows.h + self.found.fit.estimates[-1])


def aligned(estimator: BaseEstimator, start: Array, rows: Rows, found: Estimation) -> Aligned:
    """The estimation with the delay of the torques: a shift, and what remains as a parameter.

    tau(t) = W(t + T) theta is linear in T only if T is small. Therefore the torques are shifted
    until next to nothing remains, whose error enters those of the parameters. If a low-pass is the
    likelier cause, the torques are straightened too.
    """
    quick, shift, theta = estimator.quick(), 0.0, found.fit.estimates
    longest = min(LONGEST / rows.h if rows.h > 0.0 else 0.0, rows.samples / 4)
    for fit in range(FITS):
        wide = with_delay(shifted(rows, shift), theta)
        found = quick.of_rows(wide, start)
        theta = found.fit.estimates
        rest = theta[-1] / rows.h if rows.h > 0.0 else 0.0
        near = not abs(rest) > NEAR or abs(shift + rest) > longest
        if near and fit + 1 >= FEWEST:
            break
        if not near and fit > 0:
            shift += rest
    result = _likelier(Aligned(wide, found, shift), quick, start)
    if quick is estimator:
        return result
    return replace(result, found=estimator.of_rows(result.rows, start))


def _likelier(delayed: Aligned, quick: BaseEstimator, start: Array) -> Aligned:
    """As behind a delay, or as behind a low-pass, whichever is likelier."""
    rows, found = delayed.rows, delayed.found
    if not rows.h > 0.0:
        return delayed
    predicted = rows.W[:, :, :-1] @ found.fit.estimates[:-1]
    straight = straightened(rows, predicted, delayed.delay)
    other = quick.of_rows(straight, start)
    residuals = [x.y - x.W @ y.fit.estimates for x, y in ((rows, found), (straight, other))]
    ratio = log_likelihood_ratio(rows, predicted, residuals)
    probability = np.exp(-np.logaddexp(0.0, abs(ratio)))
    doubt = np.sqrt(probability) * (other.fit.estimates - found.fit.estimates)
    if ratio > CLEAR:
        return replace(delayed, rows=straight, found=other, low_pass=True, doubt=doubt)
    return replace(delayed, doubt=doubt)
