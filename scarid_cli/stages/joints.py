"""Logs as a robot's description tells them: columns, units, motors that drive its joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.logs import JOINT, LogFormat
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.table import Table, matrix, number, with_columns
from scarid_cli.stages.adapt import adapted

Way = Callable[[Array], Array]


def as_described(
    table: Table,
    robot: Robot,
    names: dict[str, str],
    units: list[tuple[str, str]],
    rate: float | None,
) -> Table:
    """`adapted` by what a robot's description says of its logs; what is given goes before that."""
    log = robot.log
    if log is None:
        raise UsageFault(f"{robot.name}: its description has no [log] that says what logs hold")
    clocked = "t" in table.columns or "t" in {**log.columns, **names}
    table = adapted(
        table,
        {**log.columns, **names},
        [*log.units, *units],
        rate if rate or clocked else log.rate,
    )
    return at_joints(table, robot, log)


def at_joints(table: Table, robot: Robot, log: LogFormat) -> Table:
    """Angles, torques or currents of motors turned into positions [rad or m] and torques of joints.

    Whatever of the two the log has of joints stays as it is.
    """
    ways: dict[tuple[str, ...], Way] = {}
    for names, way in _groups(log):
        for name in names:
            columns = [name.replace("{i}", str(i)) for i in range(1, len(robot.joints) + 1)]
            present = [column in table.columns for column in columns]
            if any(present) and not all(present):
                raise bad_data(
                    table.name,
                    f"the columns {', '.join(table.columns)}",
                    expected=f"one of each motor of {robot.name}",
                    remedy="a joint's value may depend on several motors: name them all",
                    column=columns[present.index(False)],
                )
            if all(present):
                ways[tuple(columns)] = way
    made = {column for columns in ways for column in columns}
    schema = pa.schema(
        [_field(table, robot, f.name) if f.name in made else f for f in table.schema]
    )
    meta = replace(table.meta, robot=robot.name)
    return replace(table, schema=schema, meta=meta, batches=_rows(table, schema, ways))


def _groups(log: LogFormat) -> Iterator[tuple[tuple[str, ...], Way]]:
    if log.positions != JOINT:
        yield ("q{i}", "q{i}_ref"), log.positions_of_joints
        yield ("dq{i}", "ddq{i}", "dq{i}_ref", "ddq{i}_ref"), log.velocities_of_joints
    if log.torques != JOINT:
        yield ("tau{i}",), log.torques_of_joints


def _field(table: Table, robot: Robot, name: str) -> pa.Field:
    """A torque has its joint's unit, whatever its motor's was in."""
    torques = {f"tau{i}": joint.torque_unit for i, joint in enumerate(robot.joints, start=1)}
    return number(name, torques.get(name) or table.unit(name))


def _rows(
    table: Table, schema: pa.Schema, ways: dict[tuple[str, ...], Way]
) -> Iterator[pa.RecordBatch]:
    for batch in table.batches:
        new: dict[str, Array] = {}
        for columns, way in ways.items():
            new |= dict(zip(columns, way(matrix(batch, list(columns))), strict=True))
        yield with_columns(batch, schema, new)
