"""The fit of the time by which the torques lead the motion, as behind a delay or a low-pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from scarid_cli.algorithms.effects.curvature import form
from scarid_cli.algorithms.inference.essential import without
from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.rows import Rows, predicted, thinned, with_delay
from scarid_cli.algorithms.regression.shifting import bend, in_step
from scarid_cli.algorithms.uncertainty.jackknife import jackknife
from scarid_cli.arrays import Array, spread_starts

SEARCHED = 4_000_000  # numbers in W, about, from which the lead is searched
BLOCKS = 10  # of a long record, spread over it
FITS = 10  # at most, each from the estimates of the one before
NEAR = 0.02  # of a sample: a remaining delay up to this is left to the linear form
LONGEST = 0.5  # s, of the delay
CLEAR = 0.1  # of the log-likelihood ratio: where it is less, both forms predict the same
WORSE = 1.001  # times the mean square of the residual: a step of the search that is halved
HALF = 0.5  # times it: what a delay has to explain that needs parameters which no robot has
ROUNDING = 1e-9  # of a torque, in a log without noise
TINY = 1e-300  # the least mean square, of a joint without torques
CERTAIN = 3.0  # errors within which a delay must be as usual, and what remains of it none
USUAL = 0.01  # s: delays of drives and loggers are about as long, or one interval of the log


@dataclass(frozen=True)
class Lead:
    """The time [s] by which the torques lead the motion, as behind a delay or a low-pass.

    `theta` (columns) are the estimates with which it was found, the last of them what remains of
    the delay. `doubt` (columns) is their root mean square error from two causes: the other form may
    be the true one, with the probability that the log gives it, or part of the lead may have it. If
    the log does not show the lead (`shown` is false), it is taken to be 0, without a column, and
    `doubt` is what a usual one does.
    """

    seconds: float
    theta: Array
    low_pass: bool = False
    doubt: Array | None = None
    shown: bool = True

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
    def delay(self) -> float:
        """The time [s] by which the torques lead the motion."""
        return self.lead.seconds + (float(self.found.fit.estimates[-1]) if self.lead.shown else 0.0)


def aligned(
    estimator: BaseEstimator,
    start: Array,
    rows: Rows,
    theta: Array,
    own: int,
    possible: Callable[[Array], bool] | None = None,
) -> Aligned:
    """The estimation with the delay of the torques: a shift, and what remains as a parameter.

    The search begins with the estimates `theta`, without a delay. The first `own` columns of W are
    those of the parameters; the delay moves their torques alone, not those of the ringing of
    friction: little is known of it but its size, and its derivatives are large. `possible` says
    whether a robot can have such parameters; by default all can be.

    If a low-pass is the likelier cause of the lead, the torques are straightened too. The error of
    what remains enters those of the parameters.
    """
    lead = _Search(estimator.quick(), start, own, possible).lead(_some(thinned(rows)), theta)
    if not lead.shown:
        return Aligned(rows, estimator.widened(-1).of_rows(rows, start[:-1]), lead)
    moved = lead.theta[:own]
    wide = with_delay(in_step(rows, moved, lead.seconds, low_pass=lead.low_pass), moved)
    return Aligned(wide, estimator.of_rows(wide, start), lead)


def _some(rows: Rows) -> Rows:
    """Blocks that are spread over many rows, of which the search would make several copies."""
    samples = SEARCHED // max(1, rows.W[0].size)
    if rows.samples <= 2 * samples:
        return rows
    length = samples // BLOCKS
    starts = spread_starts(rows.samples, length, BLOCKS)
    return rows.part((starts[:, None] + np.arange(length)).ravel())


@dataclass(frozen=True)
class _Shift:
    """A fit to torques that were shifted, with the column of what remains of the delay."""

    seconds: float
    rows: Rows
    found: Estimation

    @property
    def theta(self) -> Array:
        """The estimates, the last of them what remains of the delay."""
        return self.found.fit.estimates

    @property
    def residuals(self) -> Array:
        """What the fit with the column of the delay leaves of the torques (samples, joints)."""
        return np.asarray(self.rows.y - self.rows.W @ self.theta)

    @cached_property
    def alone(self) -> Array:
        """The estimates without this column, by which shifts are compared."""
        return without(self.theta, self.found.fit.unit_covariance, len(self.theta) - 1)[0][:-1]

    @cached_property
    def misfit(self) -> float:
        """The mean square of the residual without the column, a geometric mean over the joints."""
        counts = self.rows.scales > 0.0
        residuals = self.rows.y - predicted(self.rows, self.alone)
        squares, torques = (np.sum(x**2 * counts, axis=0) for x in (residuals, self.rows.y))
        squares = np.maximum(squares, ROUNDING**2 * torques + TINY)
        return float(np.exp(np.mean(np.log(squares / np.maximum(counts.sum(axis=0), 1)))))


@dataclass(frozen=True)
class _Search:
    """The search for the lead by fits from initial parameters, of which the first are `own`."""

    quick: BaseEstimator
    start: Array
    own: int
    possible: Callable[[Array], bool] | None

    def lead(self, rows: Rows, theta: Array) -> Lead:
        """The lead from these rows, by a search that begins with the estimates `theta`."""
        best = self._best(rows, self._shift(rows, theta, 0.0))
        if not rows.h > 0.0:
            return Lead(best.seconds, best.theta)
        usual = max(USUAL, rows.h)
        if best.found.scores and not self._shown(best, usual):
            return self._unknown(rows, theta, usual)
        return self._likelier(rows, best)

    def _shown(self, best: _Shift, usual: float) -> bool:
        """Whether the log shows the lead better than by the usual one, where the search has ended.

        Noise of the accelerations makes inertias too small, and a lead seems to make up for it.
        """
        error, rest = float(jackknife(best.rows, best.found).errors[-1]), float(best.theta[-1])
        return CERTAIN * error < usual and abs(rest) <= max(CERTAIN * error, NEAR * best.rows.h)

    def _unknown(self, rows: Rows, theta: Array, usual: float) -> Lead:
        """No lead, and what one of the usual size does to the estimates."""
        without, behind = (self._shift(rows, theta, t).alone for t in (0.0, usual))
        return Lead(0.0, without, doubt=behind - without, shown=False)

    def _likelier(self, rows: Rows, delay: _Shift) -> Lead:
        """The lead as behind this delay, or as behind a low-pass if that is likelier."""
        bent = bend(delay.rows, predicted(delay.rows, delay.theta[: self.own]), delay.seconds)
        straight = replace(delay.rows, y=delay.rows.y + bent)
        other = replace(delay, rows=straight, found=self.quick.of_rows(straight, self.start))
        seen = form(delay.rows, bent, [delay.residuals, other.residuals])
        low_pass = seen.ratio > CLEAR
        probability = np.exp(-np.logaddexp(0.0, abs(seen.ratio)))
        # Of a lead that is partly a delay, the other part is missed.
        missed = probability + (seen.share - low_pass) ** 2
        doubt = np.sqrt(missed) * (other.theta - delay.theta)
        found = delay
        if low_pass:
            first = self._shift(rows, delay.theta, delay.seconds, low_pass=True)
            found = self._best(rows, first, low_pass=True)
        return Lead(found.seconds, found.theta, low_pass, doubt)

    def _best(self, rows: Rows, best: _Shift, *, low_pass: bool = False) -> _Shift:
        """The shift that explains the torques best, by steps that begin with this one.

        tau(t) = W(t + T) theta is linear in T only if T is small. Therefore the torques are shifted
        until next to nothing remains. A step that explains them less well is halved, and so is one
        to an inertia below 0: where most of a torque is viscous friction, a delay is nearly the
        same as an inertia, and another one with the opposite inertia explains as much.
        """
        longest = min(LONGEST, 0.25 * rows.samples * rows.h)
        step = float(best.theta[-1])
        for _ in range(FITS):
            if not NEAR * rows.h < abs(step) <= longest - abs(best.seconds):
                break
            new = self._shift(rows, best.theta, best.seconds + step, low_pass=low_pass)
            if self._worse(new, best):
                step *= 0.5
            else:
                best, step = new, float(new.theta[-1])
        return best

    def _shift(self, rows: Rows, theta: Array, seconds: float, *, low_pass: bool = False) -> _Shift:
        """The fit to torques that are shifted by so much, with the slope that theta predicts."""
        own = theta[: self.own]
        wide = with_delay(in_step(rows, own, seconds, low_pass=low_pass), own)
        found = self.quick.of_rows(wide, self.start)
        return _Shift(seconds, wide, found)

    def _worse(self, new: _Shift, best: _Shift) -> bool:
        """Whether a shift explains the torques less well, or with parameters that no robot has.

        One that halves the mean square of the residual is there even so.
        """
        there, here = (shift.alone[: self.own] for shift in (new, best))
        lost = self.possible and self.possible(here) and not self.possible(there)
        return new.misfit > (HALF if lost else WORSE) * best.misfit
