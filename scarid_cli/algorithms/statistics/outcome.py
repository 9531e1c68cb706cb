"""From the final state of an estimator to its outcome: estimates, errors and diagnostics."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.changes.evidence import LogEvidence, evidence
from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows, with_delay
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.checkpoint import Checkpoint
from scarid_cli.algorithms.statistics.diagnostics import Diagnostics, diagnose
from scarid_cli.algorithms.statistics.essential import Essential, Noise, essential
from scarid_cli.arrays import Array

ALIGNMENTS = 3  # times that the delay is fitted, each time from the previous estimates


@dataclass(frozen=True)
class Problem:
    """An estimation and the rows that it is judged by.

    The first `own` columns of W belong to the robot's parameters, the others to nuisance
    parameters. `record` has the blocks of all rows if `rows` are a subsample.
    """

    rows: Rows
    found: Estimation
    own: int
    record: Blocks | None

    def diagnostics(self) -> Diagnostics:
        return diagnose(self.rows, self.found, self.own, self.record)

    def reduced(self, to: Essential) -> Problem:
        """The problem with only the essential parameters."""
        rows = replace(self.rows, W=np.ascontiguousarray(self.rows.W[:, :, to.kept]))
        scores = self.found.scores
        if scores and scores.instruments is not None:
            scores = replace(scores, instruments=scores.instruments[:, :, to.kept])
        return Problem(
            rows,
            replace(self.found, fit=to.fit, scores=scores),
            self.own - len(to.dropped),
            self.record.columns(to.kept) if self.record else None,
        )


@dataclass(frozen=True)
class Outcome:
    """The outcome of an estimation.

    `found` and `diagnostics` refer to the parameters with the indices `kept`; `reduction` is set if
    the model was reduced to essential parameters. `full` is the fit of all parameters, before any
    were dropped, and `errors` are its standard errors. `delay` is the fitted delay of the torques
    and its standard error [s]. `excitation` (parameters) is the root-mean-square torque that one
    unit of each parameter causes on this motion. `samples` is the number of samples. `evidence` is
    that of the rows, at these estimates, which later logs are compared with.
    """

    found: Estimation
    diagnostics: Diagnostics
    kept: list[int]
    reduction: Essential | None
    full: Fit
    errors: Array
    delay: tuple[float, float] | None
    excitation: Array
    samples: int
    evidence: LogEvidence


def outcome(
    estimator: BaseEstimator, initial: Array, end: Checkpoint, treatment: Treatment
) -> Outcome:
    """The outcome, from the checkpoint at the end of a record.

    The treatment says whether the delay of the torques is fitted too, and parameters are dropped.
    """
    whole = _problem(estimator, initial, end, align=treatment.align)
    problem, diagnostics = whole, whole.diagnostics()
    errors, reduction = diagnostics.errors[: whole.own], None
    if treatment.essential:
        noise = _noise(whole, diagnostics, float(end.subsample.counted))
        reduction = essential(whole.found.fit, noise, whole.own)
        if reduction.dropped:
            problem = whole.reduced(reduction)
            diagnostics = problem.diagnostics()
    own, fit = problem.own, problem.found.fit
    kept = (reduction.kept if reduction else list(range(own)))[:own]
    delay = (float(fit.estimates[own]), float(diagnostics.errors[own])) if treatment.align else None
    return Outcome(
        found=replace(problem.found, fit=fit.part(slice(own))),
        diagnostics=diagnostics.part(own),
        kept=kept,
        reduction=reduction,
        full=whole.found.fit.part(slice(whole.own)),
        errors=errors,
        delay=delay,
        excitation=_excitation(whole),
        samples=end.subsample.total,
        evidence=_evidence(whole, fit.estimates[:own], kept, delay[0] if delay else 0.0),
    )


def _evidence(whole: Problem, estimates: Array, kept: list[int], delay: float) -> LogEvidence:
    """The evidence about all parameters, of which those that were dropped are zero."""
    theta = np.zeros(whole.own)
    theta[kept] = estimates
    W = np.ascontiguousarray(whole.rows.W[:, :, : whole.own])
    return evidence(replace(whole.rows, W=W), theta, delay)


def _problem(estimator: BaseEstimator, initial: Array, end: Checkpoint, *, align: bool) -> Problem:
    rows, found = end.subsample.rows(), estimator.fit(end.state)
    own = len(found.fit.estimates)
    if align:
        rows, found = _aligned(estimator.widened(), np.append(initial, 0.0), rows, found)
    if found.scores and found.scores.rows:
        rows = found.scores.rows
    record = None if end.subsample.complete or not end.blocks else end.blocks.whole()
    return Problem(rows, found, own, record)


def _aligned(
    estimator: BaseEstimator, start: Array, rows: Rows, found: Estimation
) -> tuple[Rows, Estimation]:
    """The estimation with the delay of the torques as one more parameter."""
    wide = rows
    for _ in range(ALIGNMENTS):
        wide = with_delay(rows, found.fit.estimates)
        found = estimator.of_rows(wide, start)
    return wide, found


def _noise(problem: Problem, diagnostics: Diagnostics, rows: float) -> Noise:
    """How much larger the variances are than those for white residuals, as a median."""
    ratios = _ratios(problem.found.fit, diagnostics.errors)[: problem.own]
    return Noise(rows, float(np.median(ratios)), diagnostics.blocks)


def _ratios(fit: Fit, errors: Array) -> Array:
    """The squared errors, divided by the variances for white residuals (parameters)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((errors / fit.standard_errors()) ** 2, dtype=np.float64)


def covariance(full: Fit, errors: Array) -> Array | None:
    """The covariance of all estimates, scaled to their robust errors; None if it is not known.

    It is the classical covariance s^2 (W'W)^-1, multiplied by the median ratio of robust to
    classical variances. Autocorrelated residuals increase all errors, but do not change the
    directions that the motion leaves undetermined. The robust covariance itself would not do,
    because its rank is below the number of its blocks.
    """
    classical = full.variance * full.unit_covariance
    ratios = _ratios(full, errors)
    ratios = ratios[np.isfinite(ratios) & (ratios > 0.0)]
    sized: Array = classical * (np.median(ratios) if len(ratios) else 1.0)
    return sized if np.isfinite(sized).all() else None


def _excitation(problem: Problem) -> Array:
    """The root-mean-square torque per unit of each parameter (parameters)."""
    counts = problem.rows.scales > 0.0
    W = problem.rows.W[:, :, : problem.own] * counts[:, :, None]
    excitation: Array = np.sqrt((W**2).sum(axis=(0, 1)) / max(counts.sum(), 1))
    return excitation
