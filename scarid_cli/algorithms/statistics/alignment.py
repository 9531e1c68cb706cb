"""The fit of the time by which the torques lead the motion, as behind a delay or a low-pass."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.rows import Rows, predicted, thinned, with_delay
from scarid_cli.algorithms.regression.shifting import bend, in_step
from scarid_cli.algorithms.statistics.curvature import form
from scarid_cli.arrays import Array

FITS = 10  # at most, each from the estimates of the one before
FEWEST = 3  # fits, because the derivative of the torque depends on the estimates
NEAR = 0.02  # of a sample: a remaining delay up to this is left to the linear form
LONGEST = 0.5  # s, of the delay
CLEAR = 0.1  # of the log-likelihood ratio: where it is less, both forms predict the same


@dataclass(frozen=True)
class Lead:
    """The time [s] by which the torques lead the motion, as behind a delay or a low-pass.

    `theta` (columns) are the estimates with which it was found, the last of them what remains of
    the delay. `doubt` (columns) is their root mean square error from two causes: the other form may
    be the true one, with the probability that the log gives it, or part of the lead may have it.
    """

    seconds: float
    theta: Array
    low_pass: bool = False
    doubt: Array | None = None

    def part(self, kept: list[int]) -> Lead:
        """The lead with these columns alone."""
        doubt = None if self.doubt is None else self.doubt[kept]
        return replace(self, theta=self.theta[kept], doubt=doubt)


@dataclass(frozen=True)
class Aligned:
    """The rows without the lead of the torques, with the column of what remains of it; the fit."""

    rows: Rows
    found: Estimation
    lead: Lead

    @property
    def residuals(self) -> Array:
        """What the fit leaves of the torques (samples, joints)."""
        return np.asarray(self.rows.y - self.rows.W @ self.found.fit.estimates)

    @property
    def delay(self) -> float:
        """The time [s] by which the torques lead the motion."""
        return self.lead.seconds + float(self.found.fit.estimates[-1])


def aligned(estimator: BaseEstimator, start: Array, rows: Rows, theta: Array, own: int) -> Aligned:
    """The estimation with the delay of the torques: a shift, and what remains as a parameter.

    The search begins with the estimates `theta`, without a delay. The first `own` columns of W are
    those of the parameters; the delay moves their torques alone, not those of the ringing of
    friction: little is known of it but its size, and its derivatives are large.

    If a low-pass is the likelier cause of the lead, the torques are straightened too. The error of
    what remains enters those of the parameters.
    """
    lead = _Search(estimator.quick(), start, own).lead(thinned(rows), theta)
    moved = lead.theta[:own]
    wide = with_delay(in_step(rows, moved, lead.seconds, low_pass=lead.low_pass), moved)
    return Aligned(wide, estimator.of_rows(wide, start), lead)


@dataclass(frozen=True)
class _Search:
    """The search for the lead by fits from initial parameters, of which the first are `own`."""

    quick: BaseEstimator
    start: Array
    own: int

    def lead(self, rows: Rows, theta: Array) -> Lead:
        """The lead from these rows, by a search that begins with the estimates `theta`."""
        delay = self._fitted(rows, Lead(0.0, theta))
        return self._likelier(rows, delay) if rows.h > 0.0 else delay.lead

    def _likelier(self, rows: Rows, delay: Aligned) -> Lead:
        """The lead as behind this delay, or as behind a low-pass if that is likelier."""
        lead = delay.lead
        bent = bend(delay.rows, predicted(delay.rows, lead.theta[: self.own]), lead.seconds)
        straight = replace(delay.rows, y=delay.rows.y + bent)
        other = replace(delay, rows=straight, found=self.quick.of_rows(straight, self.start))
        seen = form(delay.rows, bent, [delay.residuals, other.residuals])
        low_pass = seen.ratio > CLEAR
        probability = np.exp(-np.logaddexp(0.0, abs(seen.ratio)))
        # Of a lead that is partly a delay, the other part is missed.
        missed = probability + (seen.share - low_pass) ** 2
        doubt = np.sqrt(missed) * (other.found.fit.estimates - lead.theta)
        lead = replace(lead, low_pass=low_pass, doubt=doubt)
        return self._fitted(rows, lead).lead if low_pass else lead

    def _fitted(self, rows: Rows, lead: Lead) -> Aligned:
        """The lead of this form that fits the rows, by fits that begin with this one.

        tau(t) = W(t + T) theta is linear in T only if T is small. Therefore the torques are shifted
        until next to nothing remains.
        """
        seconds, theta = lead.seconds, lead.theta
        longest = min(LONGEST, 0.25 * rows.samples * rows.h)
        for fit in range(FITS):
            own = theta[: self.own]
            wide = with_delay(in_step(rows, own, seconds, low_pass=lead.low_pass), own)
            found = self.quick.of_rows(wide, self.start)
            theta = found.fit.estimates
            rest = float(theta[-1])
            far = NEAR * rows.h < abs(rest) <= longest - abs(seconds)
            if not far and fit + 1 >= FEWEST:
                break
            if far and fit > 0:
                seconds += rest
        return Aligned(wide, found, replace(lead, seconds=seconds, theta=theta))
