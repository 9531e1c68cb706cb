"""Estimate a robot's parameters from a motion."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.information import Fit, Information, NotIdentifiableError
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData
from scarid_cli.io import schemas
from scarid_cli.io.table import Metadata, Table, doubles, matrix, number, settled
from scarid_cli.stages import Sink


class Estimator(Protocol):
    """The interface of every estimator (see `algorithms/estimators/__init__.py`)."""

    RECURSIVE: ClassVar[bool]

    def init(self, initial: Array) -> Information: ...
    def step(
        self, state: Information, W: Array, y: Array, *, trace: bool
    ) -> tuple[Information, Array]: ...
    def fit(self, state: Information) -> Fit: ...


@dataclass(frozen=True)
class Columns:
    """The columns of a motion that a robot's regression needs."""

    robot: Robot

    @property
    def names(self) -> list[str]:
        joints = range(1, len(self.robot.joints) + 1)
        return [f"{signal}{i}" for signal in ("q", "dq", "ddq", "tau") for i in joints]

    def regression(self, batch: pa.RecordBatch) -> tuple[Array, Array]:
        """W (samples, joints, parameters) and the torques (joints, samples)."""
        q, dq, ddq, tau = np.split(matrix(batch, self.names), 4)
        return self.robot.regressor(q, dq, ddq), tau


def identify(
    table: Table,
    robot: Robot,
    estimator: Estimator,
    initial: Array,
    *,
    unit_variance: bool = False,
    trace: Sink | None = None,
) -> Table:
    """The parameters, once every row of the motion has been taken in.

    `trace` receives the estimates after every sample (Fig. 6).
    """
    columns = Columns(robot)
    state = estimator.init(initial)
    samples = 0
    schema = _trace_schema(robot)
    if trace:
        meta = replace(table.meta, kind="trace", robot=robot.name)
        trace.start(replace(table, schema=schema, meta=meta).arrow_schema())
    for batch in settled(table.batches):
        W, tau = columns.regression(batch)
        state, estimates = estimator.step(
            state, W, np.ascontiguousarray(tau.T), trace=trace is not None
        )
        samples += batch.num_rows
        if trace:
            arrays = [batch.column("t"), *(doubles(e) for e in estimates.T)]
            trace.write(pa.RecordBatch.from_arrays(arrays, schema=schema))
    fit = _fit(estimator, state, robot, table.name)
    meta = replace(table.meta, kind="parameters", robot=robot.name)
    return _parameters(fit, robot, meta, samples, unit_variance=unit_variance)


def _trace_schema(robot: Robot) -> pa.Schema:
    return pa.schema([number("t", "s"), *(number(p.name, p.unit) for p in robot.parameters)])


def _fit(estimator: Estimator, state: Information, robot: Robot, name: str) -> Fit:
    try:
        return estimator.fit(state)
    except NotIdentifiableError as error:
        weights = np.abs(error.direction)
        blind = [n for n, w in zip(robot.names, weights, strict=True) if w > 0.1 * weights.max()]
        raise BadData(
            f"{name}: not identifiable: the motion leaves {' and '.join(blind)} undetermined; "
            "use a log that excites every joint"
        ) from None


def _parameters(
    fit: Fit, robot: Robot, meta: Metadata, samples: int, *, unit_variance: bool
) -> Table:
    errors = fit.standard_errors(unit_variance=unit_variance)
    with np.errstate(divide="ignore"):
        relative = 100.0 * errors / np.abs(fit.estimates)
    schema = schemas.load("parameters").arrow()
    batch = pa.RecordBatch.from_arrays(
        [
            pa.array(robot.names, pa.string()),
            pa.array([parameter.unit for parameter in robot.parameters], pa.string()),
            doubles(fit.estimates),
            known(errors),
            known(relative),
        ],
        schema=schema,
    )
    extra: dict[str, Any] = {
        "condition_number": fit.condition,
        "residual_deviation": None if np.isnan(fit.variance) else float(np.sqrt(fit.variance)),
        "samples": samples,
    }
    return Table("identify", schema, replace(meta, extra=extra), iter([batch]))


def known(values: Array) -> pa.Array:
    """A column whose values that do not exist (nan, inf) are empty cells."""
    return pa.array([x if np.isfinite(x) else None for x in values.tolist()], pa.float64())
