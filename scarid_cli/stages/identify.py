"""Estimate a robot's parameters from a motion, and judge their reliability."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import pyarrow as pa

from scarid_cli.algorithms.checks.finding import FAILED, Finding
from scarid_cli.algorithms.inference.outcome import Outcome, outcome
from scarid_cli.algorithms.inference.verdict import combination
from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.information import RESIDUAL, NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, regressed, thinning
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.algorithms.uncertainty.subsample import MOST_COVERED, Subsample
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import SEGMENT, Table, number, segment_field, with_columns
from scarid_cli.memory import limit
from scarid_cli.stages import Sink
from scarid_cli.stages.records.corrected import TORQUE_GAINS
from scarid_cli.stages.records.rows import treated
from scarid_cli.stages.records.times import Times
from scarid_cli.stages.remarks.reach import Reach
from scarid_cli.stages.remarks.suspicions import of_model, of_velocities, without_placeholders
from scarid_cli.stages.results.parameters import parameters

if TYPE_CHECKING:  # cvxpy takes a second to import
    from scarid_cli.algorithms.robots.possible import Possible

NUMBER = 8  # bytes
COPIES = 8  # of the rows at most, while they are judged (`make bench-memory`)


def identify(
    table: Table,
    robot: Robot,
    estimator: BaseEstimator,
    initial: Array,
    *,
    treatment: Treatment | None = None,
    variance: str = RESIDUAL,
    trace: Sink | None = None,
    checkpoint: Checkpoint | None = None,
    keep: Callable[[Checkpoint], None] | None = None,
    findings: list[Finding] | None = None,
    watch: Callable[[SoFar], None] | None = None,
    loaded: bool = False,
) -> Table:
    """The table of parameters, estimated from all rows of a motion.

    `initial` are the initial parameters, or zeros. `trace` receives the estimates after every
    sample (Fig. 6). `checkpoint` is the checkpoint of an earlier estimation that is continued, and
    `keep` receives that of this one. `findings` receives what is not in order with the log; what
    makes the result wrong enters the verdict as well. `watch` is offered what is known so far after
    each batch of rows, unless they are all held. A `loaded` robot carries what is not described.
    """
    findings = [] if findings is None else findings
    treatment = treatment or Treatment()
    estimator = estimator.for_robot(robot)
    if checkpoint is None:
        holds = treatment.holds or estimator.HOLDS
        held = _held(table, robot, estimator, treatment) if holds else None
        checkpoint = Checkpoint.at_start(estimator.init(initial), table.period, held)
    times, reach = Times(table, checkpoint.seen), Reach(len(robot.joints))
    watched = times.watched(reach.watched(table))
    judged = partial(
        _judged,
        table,
        robot,
        estimator,
        initial,
        treatment,
        variance,
        times,
        reach,
        loaded=loaded,
    )
    checkpoint = _after_all_rows(
        watched, robot, estimator, treatment, checkpoint, trace, watch, judged
    )
    result, further = judged(checkpoint, findings)
    if keep:
        keep(checkpoint)
    findings += further
    return result


@dataclass(frozen=True)
class SoFar:
    """What is known after some rows of a motion: `batch` are the last ones.

    `estimates` computes the estimates, and `table` the table of parameters with its verdict, which
    takes as long as at the end of the log; both raise an error where the rows do not suffice.
    """

    batch: pa.RecordBatch | None
    estimates: Callable[[], Array]
    table: Callable[[], Table]


def _judged(
    table: Table,
    robot: Robot,
    estimator: BaseEstimator,
    initial: Array,
    treatment: Treatment,
    variance: str,
    times: Times,
    reach: Reach,
    checkpoint: Checkpoint,
    findings: Sequence[Finding],
    *,
    loaded: bool = False,
) -> tuple[Table, list[Finding]]:
    """The table of parameters at a checkpoint, and what is not in order beside the findings."""
    _check_enough(table, robot, checkpoint.subsample.counted)
    try:
        found = outcome(estimator, initial, checkpoint, treatment, robot)
    except NotIdentifiableError as error:
        raise _not_identifiable(table, robot, error, findings) from None
    further = reach.findings(robot, table.period)
    if not estimator.FOLLOWS:
        rows = regressed(checkpoint.subsample.rows(), robot)
        further = without_placeholders(further, rows, robot) + of_velocities(rows)
        if all(finding.status != FAILED for finding in (*findings, *further)):
            further += of_model(rows, robot, loaded=loaded)
    every = [*findings, *further]
    bodies = None
    if treatment.consistent:
        found, bodies = _constrained(found, robot, checkpoint.subsample.rows())
    result = parameters(
        found,
        robot,
        replace(table.meta, kind="parameters", robot=robot.name),
        treatment,
        variance=variance,
        matched=_matched(table),
        unexplained=times.unexplained(found.diagnostics.bursts),
        failed=[finding.text for finding in every if finding.status == FAILED],
        bodies=bodies,
    )
    extra = dict(result.meta.extra)
    kept = ("bandwidth", "velocity_noise", TORQUE_GAINS)  # by which validate takes a later log
    extra |= {fact: value for fact in kept if (value := table.meta.extra.get(fact))}
    if treatment.counting:
        extra["left_out"] = checkpoint.left_out.counts
    return replace(result, meta=replace(result.meta, extra=extra)), further


Watch = Callable[[SoFar], None]


def _held(table: Table, robot: Robot, estimator: BaseEstimator, treatment: Treatment) -> Subsample:
    """The rows that are held: all, or of many as many as say all that their bandwidth lets pass.

    Of a log that is still too long for the memory, less are held.
    """
    numbers = limit() // (NUMBER * COPIES)
    stated = treatment.counting.bandwidth if treatment.counting else None
    bandwidth = stated or table.meta.extra.get("bandwidth")
    bare = len(robot.parameters) if treatment.align and not treatment.decimate else 0
    if treatment.align and not estimator.RECURSIVE:  # for which each row counts
        covers = min(MOST_COVERED, numbers)
        return Subsample.held(thinning(table.period, bandwidth), bare, covers)
    return Subsample.held(1, bare, sys.maxsize)


def _constrained(found: Outcome, robot: Robot, rows: Rows) -> tuple[Outcome, Possible]:
    """The outcome, and the nearest estimates that rigid bodies can have."""
    from scarid_cli.stages.results.possible import constrained  # cvxpy takes a second to import

    return constrained(found, robot, rows)


def _after_all_rows(
    table: Table,
    robot: Robot,
    estimator: BaseEstimator,
    treatment: Treatment,
    checkpoint: Checkpoint,
    trace: Sink | None,
    watch: Watch | None,
    judged: Callable[[Checkpoint, Sequence[Finding]], tuple[Table, list[Finding]]],
) -> Checkpoint:
    """The checkpoint after the last row; the trace receives the estimates after every row."""
    schema = _trace_schema(robot, table)
    if trace:
        meta = replace(table.meta, kind="trace", robot=robot.name)
        trace.start(replace(table, schema=schema, meta=meta).arrow_schema())
    parts = treated(table, robot, treatment, checkpoint.seen, estimator, checkpoint.left_out)
    allowed = limit()
    for batch, rows in parts:
        if treatment.align:  # then the rows of the subsample are fitted
            checkpoint = _with_sample(checkpoint, rows)
            _require_memory(table, checkpoint, allowed)
            continue
        checkpoint, estimates = _stepped(estimator, checkpoint, rows, trace=trace is not None)
        _require_memory(table, checkpoint, allowed)
        if watch and not estimator.HOLDS:
            so_far = partial(_table, judged, checkpoint)
            watch(SoFar(batch, partial(_estimates, estimator, checkpoint), so_far))
        if trace and batch is not None:
            new = dict(zip(robot.names, estimates.T, strict=True))
            trace.write(with_columns(batch, schema, new))
    if treatment.align:  # only then are there many rows, and none that follow
        checkpoint = replace(checkpoint, subsample=checkpoint.subsample.packed())
    return checkpoint


def _require_memory(table: Table, checkpoint: Checkpoint, allowed: int) -> None:
    """Refuse rows that could not be judged in the memory [bytes] that may be used."""
    needed = checkpoint.subsample.size * NUMBER * COPIES
    if needed > allowed:
        raise bad_data(
            table.name,
            f"rows that need {needed / 1e6:.0f} MB of memory, and more",
            expected=f"at most {allowed / 1e6:.0f} MB",
            remedy="give fewer rows (--from-time and --to-time), or allow more by SCARID_MEMORY",
        )


def _estimates(estimator: BaseEstimator, checkpoint: Checkpoint) -> Array:
    """The estimates from the rows so far."""
    return estimator.fit(checkpoint.state).fit.estimates


def _table(
    judged: Callable[[Checkpoint, Sequence[Finding]], tuple[Table, list[Finding]]],
    checkpoint: Checkpoint,
) -> Table:
    """The table of parameters from the rows so far."""
    return judged(checkpoint, ())[0]


def _matched(table: Table) -> bool:
    """Whether a motion is known to be matched: by its bandwidth, or by the rows that settle.

    Any motion with gaps has rows that settle.
    """
    settling = "settled" in table.columns and SEGMENT not in table.columns
    return settling or bool(table.meta.extra.get("bandwidth"))


def _check_enough(table: Table, robot: Robot, counted: int) -> None:
    if counted <= len(robot.names):
        raise bad_data(
            table.name,
            f"{counted} rows to fit",
            expected=f"more than the {len(robot.names)} parameters of {robot.name}",
            remedy="take a longer log, or leave out fewer rows",
        )


def _stepped(
    estimator: BaseEstimator, checkpoint: Checkpoint, rows: Rows, *, trace: bool
) -> tuple[Checkpoint, Array]:
    state, estimates = estimator.step(checkpoint.state, rows, trace=trace)
    blocks = checkpoint.blocks.add(rows) if checkpoint.blocks else None
    return replace(_with_sample(checkpoint, rows), state=state, blocks=blocks), estimates


def _with_sample(checkpoint: Checkpoint, rows: Rows) -> Checkpoint:
    """The checkpoint whose subsample has seen these rows as well."""
    seen = int(rows.at[-1]) + 1 if rows.samples else checkpoint.seen
    return replace(checkpoint, subsample=checkpoint.subsample.add(rows), seen=seen)


def _not_identifiable(
    table: Table, robot: Robot, error: NotIdentifiableError, findings: Sequence[Finding]
) -> BadData:
    """The error, which names what is wrong with the log first: the motion may be another one."""
    names = [*robot.names, *(error.added or ["the delay"])]
    left = combination(error.direction, names[: len(error.direction)])
    wrong = "; ".join(finding.text for finding in findings if finding.status == FAILED)
    remedy = f"mend the log first: {wrong}" if wrong else "use a log that excites every joint"
    return BadData(
        f"{table.name}: not identifiable: the motion leaves {left} undetermined; {remedy}"
    )


def _trace_schema(robot: Robot, table: Table) -> pa.Schema:
    fields = (number(p.name, p.unit) for p in robot.parameters)
    return pa.schema([number("t", "s"), *fields, *segment_field(table)])
