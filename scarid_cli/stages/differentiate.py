"""Estimate velocities and accelerations from positions: the soft sensor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.filters.kalman_method import KalmanMethod
from scarid_cli.algorithms.processes.bandwidth import bandwidth_of, velocity_noise
from scarid_cli.algorithms.processes.matching import settling_rows
from scarid_cli.algorithms.processes.method import MatchedForm, Method
from scarid_cli.errors import TooShort
from scarid_cli.io.facts import ORDER
from scarid_cli.io.table import SEGMENT, Table, matrix, number, without
from scarid_cli.stages.records.columns import Edges, Plan, Task, processed


def differentiate(
    table: Table,
    methods: list[Method],
    left_out: list[TooShort] | None = None,
    *,
    velocities: bool = False,
) -> Table:
    """A motion: the table with columns dq and ddq, given one method for each joint.

    In a table with gaps, each segment is differentiated by itself, and the column `settled` is 0
    in its settling rows. `left_out` receives the reason for each segment that was left out. With
    `velocities` dq is that of the table, and the methods differentiate it.
    """
    planner = _of_velocities if velocities else _plain
    return _motion(table, methods, planner, left_out, marked=SEGMENT in table.columns)


def matched(
    table: Table,
    methods: list[Method],
    left_out: list[TooShort] | None = None,
    *,
    per_joint: bool = False,
    velocities: bool = False,
) -> Table:
    """A motion whose positions and torques belong to the same instant as the derivatives.

    The column `settled` is 0 in the settling rows at both ends of the record or segment. Methods
    that tune themselves get one setting for all joints, unless each is tuned `per_joint`. With
    `velocities` dq is that of the table behind the low-pass of the method, and ddq its derivative.
    """
    together = not per_joint and len(set(methods)) == 1
    planner = _matching_velocities if velocities else _matching
    return _motion(table, methods, planner, left_out, marked=True, together=together)


UNUSED = ""  # the name of an output that is no column
PASSED = ("bandwidth", ORDER, "velocity_noise")  # the metadata of what positions have passed

Planner = Callable[[Table, list[Method]], Plan]


def _motion(
    table: Table,
    methods: list[Method],
    planner: Planner,
    left_out: list[TooShort] | None,
    *,
    marked: bool,
    together: bool = False,
) -> Table:
    """The table as a motion, with the lag of its rows [s] and the bandwidth in the metadata."""
    period = table.period
    extra = table.meta.without(*PASSED).extra
    schema = _schema(table, len(methods), [pa.field("settled", pa.int64())] if marked else [])
    if not all(method.is_fitted for method in methods):  # the others need the whole record first
        rows = inf

        def planned(segment: Table) -> tuple[Table, Plan]:
            segment, fitted = _fitted(segment, methods, together=together)
            return segment, planner(segment, fitted)
    else:
        plan = planner(table, methods)
        plan.check(period)
        rows = plan.lag(period)
        extra |= _passed(methods, period, planner)

        def planned(segment: Table) -> tuple[Table, Plan]:
            return segment, plan

    if rows:
        extra["lag"] = "whole record" if rows == inf else rows * period
    if marked and "settled" in table.columns:
        table = without(table, "settled")
    meta = replace(table.meta, kind="motion", extra=extra)
    return processed(replace(table, meta=meta), schema, planned, left_out)


def _plain(table: Table, methods: list[Method]) -> Plan:
    tasks = [
        Task(f"q{i}", method, (f"dq{i}", f"ddq{i}")) for i, method in enumerate(methods, start=1)
    ]
    if SEGMENT not in table.columns:
        return Plan(tasks)
    forms = [method.matched() for method in methods]
    return Plan(tasks, _edges(forms, table.period))


def _of_velocities(table: Table, methods: list[Method]) -> Plan:
    """The accelerations from the velocities of the table, which stay as they are."""
    tasks = [
        Task(f"dq{i}", _ungated(method), (f"ddq{i}", UNUSED))
        for i, method in enumerate(methods, start=1)
    ]
    return replace(_plain(table, methods), tasks=tasks)


def _matching_velocities(table: Table, methods: list[Method]) -> Plan:
    """As `_matching`, but with the velocities of the table behind the same low-pass."""
    plan = _matching(table, methods)
    tasks = [
        replace(t, outputs=(t.source, UNUSED, UNUSED)) if t.source[0] == "q" else t
        for t in plan.tasks
    ]
    for i, method in enumerate(methods, start=1):
        tasks.append(Task(f"dq{i}", _ungated(method).matched(), (f"dq{i}", f"ddq{i}", UNUSED)))
    return replace(plan, tasks=tasks)


def _ungated(method: Method) -> Method:
    """The method without a gate against glitches, whose width is that of the positions' noise."""
    return method.ungated() if isinstance(method, KalmanMethod) else method


def _matching(table: Table, methods: list[Method]) -> Plan:
    forms = [method.matched() for method in methods]
    tasks = []
    for i, form in enumerate(forms, start=1):
        tasks.append(Task(f"q{i}", form, (f"q{i}", f"dq{i}", f"ddq{i}")))
        if form.torque_filter and f"tau{i}" in table.columns:
            tasks.append(Task(f"tau{i}", form.torque_filter, (f"tau{i}",)))
    return Plan(tasks, _edges(forms, table.period))


def _passed(methods: list[Method], period: float, planner: Planner) -> dict[str, Any]:
    """The bandwidth [Hz] of the motion, and the noise of each velocity, as far as they are known.

    The noise is that of the positions which the settings state, within the bandwidth; that of
    measured velocities is not known.
    """
    if planner not in (_matching, _matching_velocities):
        return {}
    found = [bandwidth_of(method, period) for method in methods]
    known = [hertz for hertz in found if hertz is not None]
    if len(known) < len(found) or not known:
        return {}
    low_pass: dict[str, Any] = {"bandwidth": min(known)}
    orders = {method.two_sided_order for method in methods}
    if None not in orders and len(orders) == len(set(known)) == 1:
        low_pass |= {ORDER: orders.pop()}
    if planner is _matching_velocities:
        return low_pass
    stated = [m.noise if isinstance(m, KalmanMethod) else 0.0 for m in methods]
    noise = [velocity_noise(x, hertz, period) for x, hertz in zip(stated, known, strict=True)]
    return {**low_pass, "velocity_noise": noise}


def _edges(forms: list[MatchedForm], period: float) -> Edges:
    settling = [(0, 0)]
    for form in forms:
        form.init(0.0, period)  # refuses impossible settings
        if form.torque_filter:
            settling.append(settling_rows(form.torque_filter, period))
    before, after = (max(sides) for sides in zip(*settling, strict=True))
    return Edges(after, before)


def _fitted(table: Table, methods: list[Method], *, together: bool) -> tuple[Table, list[Method]]:
    """The table and the methods; those that tune themselves are tuned on the whole record.

    `together`: all joints have the same method, which is tuned on the positions of all.
    """
    batches = list(table.batches)
    columns = [f"q{i}" for i in range(1, len(methods) + 1)]
    positions = np.concatenate([matrix(batch, columns) for batch in batches], axis=1)
    period = table.period
    if together and methods[0].TUNES_TOGETHER:
        fitted = [methods[0].fitted(positions, period)] * len(methods)
    else:
        fitted = [method.fitted(q, period) for method, q in zip(methods, positions, strict=True)]
    return replace(table, batches=iter(batches)), fitted


def _schema(table: Table, joints: int, marks: list[pa.Field]) -> pa.Schema:
    numbers = range(1, joints + 1)
    new = [f"dq{i}" for i in numbers] + [f"ddq{i}" for i in numbers]
    kept = [f for f in table.schema if f.name not in [*new, *(mark.name for mark in marks)]]
    added = []
    for name in new:
        unit = table.unit(f"q{name.lstrip('dq')}")
        per_time = "/s2" if name.startswith("ddq") else "/s"
        added.append(number(name, unit + per_time if unit else None))
    return pa.schema(kept + added + marks)
