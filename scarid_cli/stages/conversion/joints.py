"""Convert logs by the rules in a robot's description: columns, units, and motors of its joints."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.logs import CURRENT, JOINT, LogFormat
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, number, with_columns
from scarid_cli.stages.conversion.adapt import adapted
from scarid_cli.stages.conversion.units import is_stated
from scarid_cli.stages.conversion.wording import current_as_torque

Transform = Callable[[Array], Array]


def as_described(
    table: Table,
    robot: Robot,
    names: dict[str, str],
    units: list[tuple[str, str]],
    rate: float | None,
) -> Table:
    """The table, converted by the robot's description; the arguments override the description.

    The logs of a robot without a [log] hold positions and torques of the joints.
    """
    log = robot.log or LogFormat()
    described = {new: old for new, old in log.columns.items() if old not in names.values()}
    _require_torques(robot, log, described)
    clocked = "t" in table.columns or "t" in {**described, **names}
    table = adapted(
        table,
        {**described, **names},
        [*log.units, *units],
        rate if rate or clocked else log.rate,
    )
    return at_joints(table, robot, log)


def _require_torques(robot: Robot, log: LogFormat, described: dict[str, str]) -> None:
    """Refuse a description that calls currents torques, without saying what one ampere gives."""
    for new, old in described.items():
        stated = log.torques == CURRENT or is_stated(new, log.units)
        if not stated and current_as_torque(new, old):
            raise UsageFault(
                f"{robot.name}: [log] columns: {new} = {old!r} is by its name a current and no "
                'torque; state torques = "current" and the torque_constant of each joint, or '
                f'units = {{ {new} = "0.05 N m" }}'
            )


def at_joints(table: Table, robot: Robot, log: LogFormat) -> Table:
    """Convert angles, torques or currents of motors to positions [rad or m] and torques of joints.

    Positions of joints are moved by the zeros of the description.

    Signals that the log already gives for the joints stay as they are.
    """
    transforms: dict[tuple[str, ...], Transform] = {}
    for names, transform in _groups(log):
        for name in names:
            columns = of_joints(len(robot.joints), name)
            present = [column in table.columns for column in columns]
            if any(present) and not all(present):
                raise bad_data(
                    table.name,
                    f"the columns {', '.join(table.columns)}",
                    expected=f"one for each motor of {robot.name}",
                    remedy="name the columns of all motors: a joint may depend on several of them",
                    column=columns[present.index(False)],
                )
            if all(present):
                transforms[tuple(columns)] = transform
    made = {column for columns in transforms for column in columns}
    schema = pa.schema(
        [_field(table, robot, f.name) if f.name in made else f for f in table.schema]
    )
    meta = replace(table.meta, robot=robot.name)
    return replace(table, schema=schema, meta=meta, batches=_rows(table, schema, transforms))


def _groups(log: LogFormat) -> Iterator[tuple[tuple[str, ...], Transform]]:
    if log.positions != JOINT or any(log.zero):
        yield ("q{i}", "q{i}_ref"), log.positions_of_joints
    if log.positions != JOINT:
        yield ("dq{i}", "ddq{i}", "dq{i}_ref", "ddq{i}_ref"), log.velocities_of_joints
    if log.torques != JOINT:
        yield ("tau{i}",), log.torques_of_joints


def _field(table: Table, robot: Robot, name: str) -> pa.Field:
    """A torque gets the unit of its joint, whatever the unit of the motor's signal was."""
    torques = {f"tau{i}": joint.torque_unit for i, joint in enumerate(robot.joints, start=1)}
    return number(name, torques.get(name) or table.unit(name))


def _rows(
    table: Table, schema: pa.Schema, transforms: dict[tuple[str, ...], Transform]
) -> Iterator[pa.RecordBatch]:
    for batch in table.batches:
        new: dict[str, Array] = {}
        for columns, transform in transforms.items():
            new |= dict(zip(columns, transform(matrix(batch, list(columns))), strict=True))
        yield with_columns(batch, schema, new)
