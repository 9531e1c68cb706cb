"""Estimate a robot's parameters from a motion, and say whether to believe them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression import Rows, with_delay
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.belief import LAG, Belief, believe
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.algorithms.statistics.essential import Essential, essential
from scarid_cli.algorithms.statistics.information import (
    RESIDUAL,
    Fit,
    NotIdentifiableError,
    weakest,
)
from scarid_cli.algorithms.statistics.verdict import Evidence, combination, verdict
from scarid_cli.algorithms.witness import ALL, Witness
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io import schemas
from scarid_cli.io.table import Metadata, Table, doubles, number, segment_field, with_columns
from scarid_cli.stages import Sink
from scarid_cli.stages.rows import Treatment, treated

LAGS = 5  # rows that the witness of a long record has at least in the lag that tells of bias
ALIGNMENTS = 3  # times that the delay is fitted, each from the estimates before


class Estimator(Protocol):
    """The interface of every estimator (see `algorithms/estimators/__init__.py`)."""

    RECURSIVE: ClassVar[bool]
    HOLDS: ClassVar[bool]

    def init(self, initial: Array) -> Any: ...
    def step(self, state: Any, rows: Rows, *, trace: bool = False) -> tuple[Any, Array]: ...
    def fit(self, state: Any) -> Fit: ...


@dataclass(frozen=True)
class Progress:
    """Where an estimation is: it can be saved, and go on with another log.

    `witness` and `blocks` are for the statistics, the latter unless the former holds all rows.
    `seen` are the samples so far, left out ones included.
    """

    state: Any
    witness: Witness
    blocks: Blocks | None
    seen: int = 0

    @classmethod
    def begun(cls, state: Any, h: float, *, holds: bool) -> Progress:
        """Before the first sample; samples are h [s] apart."""
        if holds:
            return cls(state, Witness(samples=ALL), None)
        thinnest = int(LAG / LAGS / h + 1e-9) if h > 0.0 else 1
        return cls(state, Witness(thinnest=max(1, thinnest)), Blocks.every(h))


def identify(
    table: Table,
    robot: Robot,
    estimator: Estimator,
    initial: Array,
    *,
    treatment: Treatment | None = None,
    variance: str = RESIDUAL,
    trace: Sink | None = None,
    progress: Progress | None = None,
    keep: Callable[[Progress], None] | None = None,
) -> Table:
    """The parameters, once every row of the motion has been taken in.

    `trace` receives the estimates after every sample (Fig. 6). `progress` is where an earlier
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
    progress = progress or Progress.begun(estimator.init(initial), period, holds=holds)
    for batch, rows in treated(table, robot, treatment, progress.seen):
        progress, estimates = _stepped(estimator, progress, rows, trace=trace is not None)
        if trace and batch is not None:
            new = dict(zip(robot.names, estimates.T, strict=True))
            trace.write(with_columns(batch, schema, new))
    _check_enough(table, robot, progress.witness.counted)
    try:
        found = _found(estimator, initial, progress, treatment, period)
    except NotIdentifiableError as error:
        raise BadData(
            f"{table.name}: not identifiable: the motion leaves "
            f"{combination(error.direction[: len(robot.names)], robot.names)} undetermined; "
            "use a log that excites every joint"
        ) from None
    meta = replace(table.meta, kind="parameters", robot=robot.name)
    if keep:
        keep(progress)
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
    estimator: Estimator, progress: Progress, rows: Rows, *, trace: bool
) -> tuple[Progress, Array]:
    state, estimates = estimator.step(progress.state, rows, trace=trace)
    seen = int(rows.at[-1]) + 1 if rows.samples else progress.seen
    blocks = progress.blocks.add(rows) if progress.blocks else None
    return Progress(state, progress.witness.add(rows), blocks, seen), estimates


@dataclass(frozen=True)
class Found:
    """What came out: the fit, its statistics, and the delay [s] with its error if it was fitted.

    `excitation` is the root-mean-square torque that a unit of each parameter makes.
    """

    fit: Fit
    excitation: Array
    belief: Belief | None
    reduced: Essential
    samples: int
    delay: tuple[float, float] | None


def _found(
    estimator: Estimator,
    initial: Array,
    progress: Progress,
    treatment: Treatment,
    period: float,
) -> Found:
    period *= float(np.prod(treatment.decimate)) if treatment.decimate else 1.0
    rows = progress.witness.rows()
    fit = estimator.fit(progress.state)
    own = len(fit.estimates)
    if treatment.align:
        fit, rows = _aligned(estimator, initial, rows, fit, period)
    rows = fit.rows or rows
    belief = None
    if fit.robust:
        record = None
        if progress.blocks and not progress.witness.complete:
            record = progress.blocks.whole()
        belief = believe(rows, fit, period * progress.witness.thin, own, record)
    delay = None
    if treatment.align and belief:
        delay = (float(fit.estimates[own]), float(belief.errors[own]))
        fit, belief = _without_nuisance(fit, belief, own)
    reduced = Essential(fit, (), 0.0)
    if treatment.essential:
        reduced = essential(fit, float((rows.scales > 0.0).sum()))
    counted = rows.W[:, :, : len(fit.estimates)] * (rows.scales > 0.0)[:, :, None]
    excitation = np.sqrt((counted**2).sum(axis=(0, 1)) / max((rows.scales > 0.0).sum(), 1))
    return Found(fit, excitation, belief, reduced, progress.witness.total, delay)


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


def _without_nuisance(fit: Fit, belief: Belief, own: int) -> tuple[Fit, Belief]:
    return (
        replace(
            fit, estimates=fit.estimates[:own], unit_covariance=fit.unit_covariance[:own, :own]
        ),
        replace(belief, errors=belief.errors[:own]),
    )


def _trace_schema(robot: Robot, table: Table) -> pa.Schema:
    parameters = (number(p.name, p.unit) for p in robot.parameters)
    return pa.schema([number("t", "s"), *parameters, *segment_field(table)])


def _parameters(found: Found, robot: Robot, meta: Metadata, *, variance: str) -> Table:
    fit, belief = found.reduced.fit, found.belief
    names = [*robot.names, *(name for name, _ in fit.added)]
    units = [*(p.unit for p in robot.parameters), *(unit for _, unit in fit.added)]
    errors = fit.standard_errors(variance=variance)
    robust = belief.errors.copy() if belief else np.full(len(names), np.nan)
    robust[list(found.reduced.dropped)] = np.nan
    half = robust * (belief.quantile if belief else np.nan)
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
    extra = _told(found, robot, names, robust if belief else errors)
    return Table("identify", schema, replace(meta, extra=extra), iter([batch]))


def _told(found: Found, robot: Robot, names: list[str], errors: Array) -> dict[str, Any]:
    """What the metadata say of the estimation, the verdict among it."""
    fit, belief = found.fit, found.belief
    scaled, direction = weakest(fit.unit_covariance)
    evidence = Evidence(
        names=[n for i, n in enumerate(names) if i not in found.reduced.dropped],
        estimates=np.delete(found.reduced.fit.estimates, found.reduced.dropped),
        errors=np.delete(errors, found.reduced.dropped),
        condition=fit.condition,
        scaled_condition=scaled,
        weak=combination(direction, names),
        belief=belief,
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
    }
    if belief:
        extra["joints"] = [asdict(joint) for joint in belief.joints]
        extra["lag_share"] = belief.lag_share
    if found.delay:
        extra["delay"], extra["delay_error"] = found.delay
    if found.reduced.dropped:
        extra["dropped"] = [names[i] for i in found.reduced.dropped]
        extra["dropped_cost"] = found.reduced.cost
    return extra


def known(values: Array) -> pa.Array:
    """A column whose values that do not exist (nan, inf) are empty cells."""
    return pa.array([x if np.isfinite(x) else None for x in values.tolist()], pa.float64())
