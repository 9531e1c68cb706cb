"""From an estimator's state to what is reported: estimates, their errors, whether they hold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows, with_delay
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.diagnostics import Diagnostics, diagnose
from scarid_cli.algorithms.statistics.essential import Essential, Noise, essential
from scarid_cli.algorithms.statistics.subsample import Subsample
from scarid_cli.arrays import Array

ALIGNMENTS = 3  # times that the delay is fitted, each from the estimates before


@dataclass(frozen=True)
class Problem:
    """The rows that an estimation is judged by, and what it found in them.

    The first `own` columns are those of parameters, the others nuisances. `record` has the blocks
    of all rows where `rows` are a subsample.
    """

    rows: Rows
    found: Estimation
    own: int
    record: Blocks | None

    def diagnostics(self) -> Diagnostics:
        return diagnose(self.rows, self.found, self.own, self.record)

    def reduced(self, to: Essential) -> Problem:
        """With the essential parameters alone."""
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
    """What came of an estimation.

    `found` and `diagnostics` are those of the parameters with the numbers `kept`; `reduction` is
    there if essential parameters were asked for. `full` is the fit of all parameters, before any
    were dropped, with its `errors`. `delay` is that of the torques [s] with its error, if it was
    fitted. `excitation` (parameters) is the root-mean-square torque that a unit of each parameter
    makes.
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


def outcome(
    estimator: BaseEstimator,
    initial: Array,
    state: Any,
    subsample: Subsample,
    record: Blocks | None,
    *,
    align: bool = False,
    reduce: bool = False,
) -> Outcome:
    """From the last state of an estimator, and what was kept of its rows.

    `align`: fit the delay of the torques as well. `reduce`: to essential parameters.
    """
    whole = _problem(estimator, initial, state, subsample, record, align=align)
    problem, diagnostics = whole, whole.diagnostics()
    errors, reduction = diagnostics.errors[: whole.own], None
    if reduce:
        noise = _noise(whole, diagnostics, float(subsample.counted))
        reduction = essential(whole.found.fit, noise, whole.own)
        if reduction.dropped:
            problem = whole.reduced(reduction)
            diagnostics = problem.diagnostics()
    own, fit = problem.own, problem.found.fit
    return Outcome(
        found=replace(problem.found, fit=fit.part(slice(own))),
        diagnostics=diagnostics.part(own),
        kept=(reduction.kept if reduction else list(range(own)))[:own],
        reduction=reduction,
        full=whole.found.fit.part(slice(whole.own)),
        errors=errors,
        delay=(float(fit.estimates[own]), float(diagnostics.errors[own])) if align else None,
        excitation=_excitation(whole),
        samples=subsample.total,
    )


def _problem(
    estimator: BaseEstimator,
    initial: Array,
    state: Any,
    subsample: Subsample,
    record: Blocks | None,
    *,
    align: bool,
) -> Problem:
    rows, found = subsample.rows(), estimator.fit(state)
    own = len(found.fit.estimates)
    if align:
        rows, found = _aligned(estimator.widened(), np.append(initial, 0.0), rows, found)
    if found.scores and found.scores.rows:
        rows = found.scores.rows
    if record and subsample.complete:
        record = None
    return Problem(rows, found, own, record.whole() if record else None)


def _aligned(
    estimator: BaseEstimator, start: Array, rows: Rows, found: Estimation
) -> tuple[Rows, Estimation]:
    """The estimation with the delay of the torques as one more parameter."""
    wide = rows
    for _ in range(ALIGNMENTS):
        wide = with_delay(rows, found.fit.estimates)
        found = estimator.fit(estimator.step(estimator.init(start), wide)[0])
    return wide, found


def _noise(problem: Problem, diagnostics: Diagnostics, rows: float) -> Noise:
    """How much more uncertain than for white residuals the estimates are, on average."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = diagnostics.errors / problem.found.fit.standard_errors()
    return Noise(rows, float(np.mean(ratio[: problem.own] ** 2)), diagnostics.blocks)


def covariance(full: Fit, errors: Array) -> Array | None:
    """The covariance of all estimates, sized to their errors; None if it is not known.

    The classical one, s^2 (W'W)^-1, times the median ratio of the variances to its own:
    autocorrelated residuals increase all errors, but which directions the motion does not determine
    stays the same. The robust covariance itself has a rank below the number of its blocks.
    """
    classical = full.variance * full.unit_covariance
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = errors**2 / np.diag(classical)
    ratios = ratios[np.isfinite(ratios) & (ratios > 0.0)]
    sized: Array = classical * (np.median(ratios) if len(ratios) else 1.0)
    return sized if np.isfinite(sized).all() else None


def _excitation(problem: Problem) -> Array:
    counts = problem.rows.scales > 0.0
    W = problem.rows.W[:, :, : problem.own] * counts[:, :, None]
    excitation: Array = np.sqrt((W**2).sum(axis=(0, 1)) / max(counts.sum(), 1))
    return excitation
