"""Estimate a robot's parameters from a motion, and say whether to believe them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.information import (
    RESIDUAL,
    Fit,
    NotIdentifiableError,
    weakest,
)
from scarid_cli.algorithms.regression.rows import Rows, with_delay
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.diagnostics import LAG, Diagnostics, diagnose
from scarid_cli.algorithms.statistics.essential import Essential, essential
from scarid_cli.algorithms.statistics.subsample import ALL, Subsample
from scarid_cli.algorithms.statistics.verdict import Evidence, combination, verdict
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io import schemas
from scarid_cli.io.table import Metadata, Table, doubles, number, segment_field, with_columns
from scarid_cli.stages import Sink
from scarid_cli.stages.rows import Treatment, treated

LAGS = 5  # rows that the subsample of a long record has at least in the lag that tells of bias
ALIGNMENTS = 3  # times that the delay is fitted, each from the estimates before


class Estimator(Protocol):
    """The interface of every estimator (see `algorithms/estimators/__init__.py`)."""

    RECURSIVE: ClassVar[bool]
    HOLDS: ClassVar[bool]

    def init(self, initial: Array) -> Any: ...
    def step(self, state: Any, rows: Rows, *, trace: bool = False) -> tuple[Any, Array]: ...
    def fit(self, state: Any) -> Fit: ...


@dataclass(frozen=True)
class Checkpoint:
    """Where an estimation is: it can be saved, and go on with another log.

    `subsample` and `blocks` are for the statistics, the latter unless the former holds all rows.
    `seen` are the samples so far, left out ones included.
    """

    state: Any
    subsample: Subsample
    blocks: Blocks | None
    seen: int = 0

    @classmethod
    def begun(cls, state: Any, h: float, *, holds: bool) -> Checkpoint:
        """Before the first sample; samples are h [s] apart."""
        if holds:
            return cls(state, Subsample(samples=ALL), None)
        thinnest = int(LAG / LAGS / h + 1e-9) if h > 0.0 else 1
        return cls(state, Subsample(thinnest=max(1, thinnest)), Blocks.every(h))


def identify(
    table: Table,
    robot: Robot,
    estimator: Estimator,
    initial: Array,
    *,
    treatment: Treatment | None = None,
    variance: str = RESIDUAL,
    trace: Sink | None = None,
    checkpoint: Checkpoint | None = None,
    keep: Callable[[Checkpoint], None] | None = None,
) -> Table:
    """The parameters, once every row of the motion has been taken in.

    `trace` receives the estimates after every sample (Fig. 6). `checkpoint` is where an earlier
    estimation left off, `keep` receives where this one does.
    """
    treatment = treatment or Treatment()
    period = table.meta.period or 0.0
    if hasattr(estimator, "for_robot"):
        estimator = estimator.for_robot(robot, period)
    if trace:
        schema = _trace_schema(robot, table)
        meta = replace(table.meta, kind="trace", robot=robot.name)
        trace.start(replace(table, schema=schema, meta=meta).arrow_schema())
    holds = treatment.holds or estimator.HOLDS
    checkpoint = checkpoint or Checkpoint.begun(estimator.init(initial), period, holds=holds)
    for batch, rows in treated(table, robot, treatment, checkpoint.seen):
        checkpoint, estimates = _stepped(estimator, checkpoint, rows, trace=trace is not None)
        if trace and batch is not None:
            new = dict(zip(robot.names, estimates.T, strict=True))
            trace.write(with_columns(batch, schema, new))
    _check_enough(table, robot, checkpoint.subsample.counted)
    try:
        found = _found(estimator, initial, checkpoint, treatment, period)
    except NotIdentifiableError as error:
        raise BadData(
            f"{table.name}: not identifiable: the motion leaves "
            f"{combination(error.direction[: len(robot.names)], robot.names)} undetermined; "
            "use a log that excites every joint"
        ) from None
    meta = replace(table.meta, kind="parameters", robot=robot.name)
    if keep:
        keep(checkpoint)
    return _parameters(found, robot, meta, variance=variance)


def _check_enough(table: Table, robot: Robot, counted: int) -> None:
    if counted <= len(robot.names):
        raise bad_data(
            table.name,
            f"{counted} rows that count",
            expected=f"more than the {len(robot.names)} parameters of {robot.name}",
            remedy="take a longer log, or leave out fewer rows",
        )


def _stepped(
    estimator: Estimator, checkpoint: Checkpoint, rows: Rows, *, trace: bool
) -> tuple[Checkpoint, Array]:
    state, estimates = estimator.step(checkpoint.state, rows, trace=trace)
    seen = int(rows.at[-1]) + 1 if rows.samples else checkpoint.seen
    blocks = checkpoint.blocks.add(rows) if checkpoint.blocks else None
    return Checkpoint(state, checkpoint.subsample.add(rows), blocks, seen), estimates


@dataclass(frozen=True)
class Found:
    """What came out: the fit, its statistics, and the delay [s] with its error if it was fitted.

    `excitation` is the root-mean-square torque that a unit of each parameter makes.
    """

    fit: Fit
    excitation: Array
    diagnostics: Diagnostics | None
    reduced: Essential
    samples: int
    delay: tuple[float, float] | None


def _found(
    estimator: Estimator,
    initial: Array,
    checkpoint: Checkpoint,
    treatment: Treatment,
    period: float,
) -> Found:
    period *= float(np.prod(treatment.decimate)) if treatment.decimate else 1.0
    rows = checkpoint.subsample.rows()
    fit = estimator.fit(checkpoint.state)
    own = len(fit.estimates)
    if treatment.align:
        fit, rows = _aligned(estimator, initial, rows, fit, period)
    rows = fit.rows or rows
    diagnostics = None
    if fit.robust:
        record = None
        if checkpoint.blocks and not checkpoint.subsample.complete:
            record = checkpoint.blocks.whole()
        diagnostics = diagnose(rows, fit, period * checkpoint.subsample.thin, own, record)
    delay = None
    if treatment.align and diagnostics:
        delay = (float(fit.estimates[own]), float(diagnostics.errors[own]))
        fit, diagnostics = _without_nuisance(fit, diagnostics, own)
    reduced = Essential(fit, (), 0.0)
    if treatment.essential:
        reduced = essential(fit, float((rows.scales > 0.0).sum()))
    counted = rows.W[:, :, : len(fit.estimates)] * (rows.scales > 0.0)[:, :, None]
    excitation = np.sqrt((counted**2).sum(axis=(0, 1)) / max((rows.scales > 0.0).sum(), 1))
    return Found(fit, excitation, diagnostics, reduced, checkpoint.subsample.total, delay)


def _aligned(
    estimator: Estimator, initial: Array, rows: Rows, fit: Fit, period: float
) -> tuple[Fit, Rows]:
    """The fit with the delay of the torques as one more parameter."""
    start = np.append(initial, 0.0)
    wide = rows
    for _ in range(ALIGNMENTS):
        wide = with_delay(rows, fit.estimates, period)
        fit = estimator.fit(estimator.step(estimator.init(start), wide)[0])
    return fit, wide


def _without_nuisance(fit: Fit, diagnostics: Diagnostics, own: int) -> tuple[Fit, Diagnostics]:
    return (
        replace(
            fit, estimates=fit.estimates[:own], unit_covariance=fit.unit_covariance[:own, :own]
        ),
        replace(diagnostics, errors=diagnostics.errors[:own]),
    )


def _trace_schema(robot: Robot, table: Table) -> pa.Schema:
    parameters = (number(p.name, p.unit) for p in robot.parameters)
    return pa.schema([number("t", "s"), *parameters, *segment_field(table)])


def _parameters(found: Found, robot: Robot, meta: Metadata, *, variance: str) -> Table:
    fit, diagnostics = found.reduced.fit, found.diagnostics
    names = [*robot.names, *(name for name, _ in fit.added)]
    units = [*(p.unit for p in robot.parameters), *(unit for _, unit in fit.added)]
    errors = fit.standard_errors(variance=variance)
    robust = diagnostics.errors.copy() if diagnostics else np.full(len(names), np.nan)
    robust[list(found.reduced.dropped)] = np.nan
    half = robust * (diagnostics.quantile if diagnostics else np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = 100.0 * errors / np.abs(fit.estimates)
    schema = schemas.load("parameters").arrow()
    columns = [
        pa.array(names, pa.string()),
        pa.array(units, pa.string()),
        doubles(fit.estimates),
        known(errors),
        known(relative),
        known(robust),
        known(fit.estimates - half),
        known(fit.estimates + half),
    ]
    if robot.body:
        written = [p.stands_for or p.name for p in robot.parameters]
        columns.append(pa.array([*written, *names[len(written) :]], pa.string()))
    else:
        schema = schema.remove(schema.get_field_index("stands_for"))
    batch = pa.RecordBatch.from_arrays(columns, schema=schema)
    extra = _told(found, robot, names, robust if diagnostics else errors)
    return Table("identify", schema, replace(meta, extra=extra), iter([batch]))


def _told(found: Found, robot: Robot, names: list[str], errors: Array) -> dict[str, Any]:
    """What the metadata say of the estimation, the verdict among it."""
    fit, diagnostics = found.fit, found.diagnostics
    scaled, direction = weakest(fit.unit_covariance)
    evidence = Evidence(
        names=[n for i, n in enumerate(names) if i not in found.reduced.dropped],
        estimates=np.delete(found.reduced.fit.estimates, found.reduced.dropped),
        errors=np.delete(errors, found.reduced.dropped),
        condition=fit.condition,
        scaled_condition=scaled,
        weak=combination(direction, names),
        diagnostics=diagnostics,
    )
    judged = verdict(evidence, robot)
    extra: dict[str, Any] = {
        "condition_number": fit.condition if np.isfinite(fit.condition) else None,
        "scaled_condition_number": scaled,
        # Of weighted rows it is near 1 and says nothing; `joints` has theirs.
        "residual_deviation": float(np.sqrt(fit.variance))
        if fit.variance >= 0.0 and fit.whitening is None
        else None,
        "samples": found.samples,
        "excitation": dict(zip(names, found.excitation.tolist(), strict=False)),
        "verdict": judged.grade,
        "reasons": list(judged.reasons),
        **fit.extra,
        "covariance": _covariance(fit, diagnostics),
    }
    if diagnostics:
        extra["joints"] = [asdict(joint) for joint in diagnostics.joints]
        extra["lag_share"] = diagnostics.lag_share
    if found.delay:
        extra["delay"], extra["delay_error"] = found.delay
    if found.reduced.dropped:
        extra["dropped"] = [names[i] for i in found.reduced.dropped]
        extra["dropped_cost"] = found.reduced.cost
        extra["full_estimates"] = fit.estimates.tolist()
    return extra


def _covariance(fit: Fit, diagnostics: Diagnostics | None) -> list[list[float]] | None:
    """The covariance of all estimates, before any were dropped; None if it is not known.

    The classical one, s^2 (W'W)^-1, times the median ratio of the robust variances to its own:
    autocorrelated residuals make all errors greater, but which directions the motion does not
    determine stays the same. The robust covariance has a rank of fewer than its blocks.
    """
    covariance = fit.variance * fit.unit_covariance
    if diagnostics:
        ratios = diagnostics.errors**2 / np.diag(covariance)
        ratios = ratios[np.isfinite(ratios) & (ratios > 0.0)]
        covariance *= np.median(ratios) if len(ratios) else 1.0
    nested: list[list[float]] = covariance.tolist()
    return nested if np.isfinite(covariance).all() else None


def known(values: Array) -> pa.Array:
    """A column whose values that do not exist (nan, inf) are empty cells."""
    return pa.array([x if np.isfinite(x) else None for x in values.tolist()], pa.float64())
