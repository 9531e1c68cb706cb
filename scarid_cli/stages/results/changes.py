"""Whether a log still fits the identification: the verdict of `scarid validate`.

The parameter table carries the evidence of the log that it was identified from. A table without it
(CSV) has errors at best; the evidence is then taken to be like that of the new log, as large as the
errors say.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.beyond.additions import gains
from scarid_cli.algorithms.changes.columns import Columns
from scarid_cli.algorithms.changes.evidence import LogEvidence, Products
from scarid_cli.algorithms.changes.explanation import Change, change
from scarid_cli.algorithms.changes.hypotheses import DELAY, OFFSET, SEARCHED, columns_of, hypotheses
from scarid_cli.algorithms.changes.wiring import rewired
from scarid_cli.algorithms.changes.wording import (
    UNCHANGED,
    UNEXPLAINED,
    Verdict,
    of_change,
    of_wiring,
)
from scarid_cli.algorithms.effects.ringing import with_ringing
from scarid_cli.algorithms.inference.verdict import VAGUE
from scarid_cli.algorithms.regression.normal_equations import inverse
from scarid_cli.algorithms.regression.rows import Rows, without_slow
from scarid_cli.algorithms.regression.shifting import in_step
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.bursts import bursts_of
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.arrays import Array, median
from scarid_cli.io.table import Table
from scarid_cli.stages.records.times import CAUSE, Times, spans
from scarid_cli.stages.results.parameters import BIASES, EVIDENCE, SLOW, Identified


@dataclass(frozen=True)
class Known:
    """What a parameter table says about the log that it was identified from.

    `evidence` is that log's, None if the table does not have it; `errors` (parameters) are the
    standard errors of the estimates, nan where there are none, and `covariance` (parameters,
    parameters) has what they have in common, None if it is not known. `torques` (joints) are half
    the 95 % intervals of the predicted torques, relative to the torques, 0 where they are not
    known, `slow` (joints) the velocities below which rows were left out [rad/s or m/s], if any
    were, and `sizes` (joints) the root mean squares of the torques, nan where they are not known,
    as `residuals` (joints), those of the estimates relative to the torques.
    """

    evidence: LogEvidence | None
    errors: Array
    torques: Array | float = 0.0
    sizes: Array | float = np.nan
    residuals: Array | float = np.nan
    covariance: Array | None = None
    slow: tuple[float, ...] = ()

    def ratios(self, now: LogEvidence, powers: Array) -> Array | None:
        """The residuals of a log, divided by those at identification (joints), if these are known.

        Noise and errors of a model grow with the torques, so what counts is the smaller one of
        their ratio and that of the residuals relative to the torques, of mean squares `powers`.
        """
        if self.evidence is None:
            return None
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = np.nan_to_num(now.deviations / self.evidence.deviations, posinf=1.0)
            return np.asarray(ratios * np.fmin(self.sizes / np.sqrt(powers), 1.0))

    def alike(self, rows: Rows) -> Rows:
        """The rows without those that the identification knows nothing of: slow ones."""
        return without_slow(rows, np.array(self.slow)) if self.slow else rows

    def fitted(self, powers: Array) -> Array:
        """The residuals at identification, relative to the torques (joints); nan if not known.

        Relative to those then, or to those now, of mean squares `powers`, whichever is larger.
        """
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(self.residuals * np.fmax(self.sizes / np.sqrt(powers), 1.0))

    def allowed(self, sums: Products) -> Array:
        """Half the 95 % intervals of the torques of a log, relative to these (joints).

        They are those that the errors of the parameters give on its motion.
        """
        if self.covariance is None or self.evidence is None:
            return np.zeros(len(sums.powers))
        count = sums.values.shape[2] - 1 - len(self.covariance)
        wide = np.pad(self.covariance, (0, count))
        return quantile(0.975, self.evidence.blocks - 1.0) * sums.torque_shares(wide)

    @property
    def remark(self) -> str:
        """What the verdict lacks, to be reported; empty if it lacks nothing."""
        if self.evidence:
            return ""
        if not self.testable:
            return (
                "no verdict, because the parameters have no errors; validate a table of "
                "`identify -o FILE.parquet`"
            )
        return (
            "CSV does not keep the residuals of the identification, so the verdict tests neither "
            "the delay nor offsets and zeros, and assumes a similar log: `identify -o FILE.parquet`"
        )

    @property
    def testable(self) -> bool:
        return self.evidence is not None or bool(np.isfinite(self.errors).any())


def known(table: Table, robot: Robot, errors: Array) -> Known:
    """What the table says, for the robot as it was identified."""
    stored = table.meta.extra.get(EVIDENCE)
    if not stored:
        return Known(None, errors, slow=_slow(table))
    names, joints = robot.names, len(robot.joints)
    p = len(stored["columns"])
    if stored["columns"][: len(names)] != names or len(stored["deviations"]) != joints:
        return Known(None, errors)
    # Older tables have less columns.
    q, there = Columns(p, joints).count, len(stored["score"])
    lower, score = np.zeros((q, q)), np.zeros(q)
    lower[np.tril_indices(there)], score[:there] = stored["information"], stored["score"]
    kept = np.array([*range(len(names)), *range(p, q)])
    information = (lower + np.tril(lower, -1).T)[np.ix_(kept, kept)]
    biases = np.array(stored.get(BIASES, [])).reshape(-1, p)[:, : len(names)]
    found = LogEvidence(
        information,
        score[kept],
        np.array(stored["deviations"]),
        np.zeros((stored["blocks"], len(kept))),
        np.pad(biases, ((0, 0), (0, len(kept) - len(names)))),
    )
    return Known(
        found,
        errors,
        _torques(table, joints, found.blocks),
        _of_joints(table, joints, "torque"),
        0.01 * _of_joints(table, joints, "relative_error"),
        _covariance(table, len(names)),
        _slow(table),
    )


def _slow(table: Table) -> tuple[float, ...]:
    """The velocities (joints) below which rows were left out; empty if none were."""
    return tuple(map(float, table.meta.extra.get(SLOW) or ()))


def _covariance(table: Table, parameters: int) -> Array | None:
    """That of the estimates (parameters, parameters), if the table has it for all of them."""
    found = np.array(table.meta.extra.get("covariance", []), np.float64)
    return found if found.shape == (parameters, parameters) else None


def _of_joints(table: Table, joints: int, fact: str) -> Array:
    """A fact of each joint (joints), nan where it is not known."""
    found = np.array([x.get(fact) for x in table.meta.extra.get("joints", [])], np.float64)
    return found if len(found) == joints else np.full(joints, np.nan)


def _torques(table: Table, joints: int, blocks: int) -> Array:
    """Half the 95 % intervals of the predicted torques, relative to the torques (joints)."""
    stated = _of_joints(table, joints, "torque_error")
    known = np.isfinite(stated).all()
    return quantile(0.975, blocks - 1.0) * (stated if known else np.zeros(joints))


def verdict(
    rows: Rows, model: Identified, before: Known, residuals: Array, times: Times
) -> Verdict:
    """The verdict on the rows of a log, with the `times` at which its torques are not explained.

    `residuals` (joints) are those of the whole log, relative to its torques.
    """
    robot, theta = model.robot, model.theta
    steps = rewired(robot, rows, theta)
    if steps:
        return of_wiring(steps)
    rows = in_step(rows, theta, model.delay, low_pass=model.low_pass)
    wide = model.shapes.compared(rows)
    sums = Products.of(with_ringing(wide, robot), theta, model=model.model)
    powers = sums.powers * gains(model.additions, len(robot.joints)) ** 2  # of the logged torques
    now = sums.usual
    first = before.evidence or _alike(now, before.errors[: len(theta)], robot)
    possible = hypotheses(robot)
    ratios = before.ratios(now, powers)
    if before.evidence is None:
        possible = [h for h in possible if h.kind not in (DELAY, OFFSET, *SEARCHED)]
    values = dict(zip(robot.names, theta.tolist(), strict=True))
    found = change(first, sums, possible)
    slight = _slight(found, sums, first, now, before)
    expected = before.fitted(powers), before.allowed(sums)
    judged = of_change(found, values, ratios, residuals, expected, slight)
    as_before = judged.grade == UNCHANGED and ratios is not None
    return judged if as_before else _with_times(judged, rows, theta, times)


def _slight(
    found: Change, sums: Products, first: LogEvidence, now: LogEvidence, before: Known
) -> float | None:
    """The part of a torque that the change makes, where no torque changes beyond its interval.

    The intervals are those that the identification states. A change that is not one of those with
    a name has as many directions as there are parameters, and two logs that determine them: then
    they are the 95 % intervals of the difference of the torques on this motion.
    """
    if not (found.changed and found.whole):
        return None
    shares = sums.torque_shares(np.outer(found.amounts, found.amounts))
    intervals = before.torques
    if not found.complete:
        columns = len(now.score)
        own = slice(now.columns.parameters)
        covariance = np.zeros((columns, columns))
        covariance[own, own] = sum(inverse(log.information[own, own]) for log in (first, now))
        if first.biases is not None:
            covariance += first.biases.T @ first.biases
        factor = quantile(0.975, min(first.blocks, now.blocks) - 1.0)
        intervals = factor * sums.torque_shares(covariance)
    return float(shares.max()) if np.all(shares <= np.minimum(intervals, VAGUE)) else None


def _with_times(judged: Verdict, rows: Rows, theta: Array, times: Times) -> Verdict:
    """The verdict with the times of the largest residuals, if they are few."""
    found = times.of(bursts_of(rows, theta))
    if not found:
        return judged
    more = f"most of the squares of the residual are those at {spans(found)} ({CAUSE})"
    grade = UNEXPLAINED if judged.grade == UNCHANGED else judged.grade
    return replace(judged, grade=grade, reason=f"{judged.reason}; {more}")


def _alike(now: LogEvidence, errors: Array, robot: Robot) -> LogEvidence:
    """LogEvidence of the shape of this log's and of the size that the errors imply.

    It says nothing about the delay, offsets that are not parameters, and all that is searched for.
    """
    p = len(errors)
    own = np.diag(inverse(now.information[:p, :p]))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = own / errors**2
    size = median(ratios[np.isfinite(ratios) & (ratios > 0.0)])
    information = size * now.information
    columns = columns_of(robot)
    unknown = [columns.delay, *range(columns.offsets.start, columns.count)]
    information[unknown] = information[:, unknown] = 0.0
    return replace(now, information=information, score=np.zeros_like(now.score))
