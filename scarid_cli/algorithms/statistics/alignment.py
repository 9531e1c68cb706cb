"""The fit of the time by which the torques lead the motion."""

from __future__ import annotations

from dataclasses import dataclass, replace

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.rows import Rows, with_delay
from scarid_cli.algorithms.regression.shifting import shifted
from scarid_cli.arrays import Array

FITS = 10  # at most, each from the estimates of the one before
FEWEST = 3  # fits, because the derivative of the torque depends on the estimates
NEAR = 0.02  # of a sample: a remaining delay up to this is left to the linear form
LONGEST = 0.5  # s, of the delay


@dataclass(frozen=True)
class Aligned:
    """The rows with the torques shifted, and the column of the remaining delay; the estimation.

    The torques were shifted by so many samples (`shift`).
    """

    rows: Rows
    found: Estimation
    shift: float

    @property
    def delay(self) -> float:
        """The time [s] by which the torques lead the motion."""
        return float(self.shift * self.rows.h + self.found.fit.estimates[-1])


def aligned(estimator: BaseEstimator, start: Array, rows: Rows, found: Estimation) -> Aligned:
    """The estimation with the delay of the torques: a shift, and what remains as a parameter.

    tau(t) = W(t + T) theta is linear in T only if T is small. Therefore the torques are shifted
    until next to nothing remains, whose error enters those of the parameters.
    """
    quick, shift, result = estimator.quick(), 0.0, Aligned(rows, found, 0.0)
    longest = min(LONGEST / rows.h if rows.h > 0.0 else 0.0, rows.samples / 4)
    for fit in range(FITS):
        wide = with_delay(shifted(rows, shift), result.found.fit.estimates)
        result = Aligned(wide, quick.of_rows(wide, start), shift)
        rest = result.found.fit.estimates[-1] / rows.h if rows.h > 0.0 else 0.0
        near = not abs(rest) > NEAR or abs(shift + rest) > longest
        if near and fit + 1 >= FEWEST:
            break
        if not near and fit > 0:
            shift += rest
    if quick is estimator:
        return result
    return replace(result, found=estimator.of_rows(result.rows, start))
