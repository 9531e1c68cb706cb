"""Whether a table is one of the robot that is used for it."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.schemas import numbered

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot
    from scarid_cli.io.table import Table


def another(robot: Robot, tables: Iterable[Table]) -> str:
    """A remark on the first table whose metadata states another robot; empty if there is none."""
    for table in tables:
        if table.meta.robot and _file(table.meta.robot) != _file(robot.name):
            return (
                f"warning: {table.name} is a table of robot {table.meta.robot} by its metadata, "
                f"and not of {robot.name}, which is used"
            )
    return ""


def require_as_many(assumed: Robot, tables: Iterable[Table]) -> None:
    """Refuse to assume a robot for a table of another number of joints."""
    joints = len(assumed.joints)
    for table in tables:
        found = len(numbered(table.columns, "q"))
        if found and found != joints:
            many = f"{found} joint{'s' if found > 1 else ''}"
            raise UsageFault(
                f"{table.name}: no robot is stated for this table of {many}; state it with --robot "
                "(a URDF or TOML file, or a name) or SCARID_ROBOT"
            )


def require_torques(table: Table) -> None:
    """Refuse a log of positions without any torque or current."""
    if numbered(table.columns, "q") and not numbered(table.columns, "tau"):
        currents = numbered(table.columns, "current")
        raise bad_data(
            table.name,
            "currents, and no torques" if currents else "no torques",
            expected="tau1, tau2, ... beside the positions",
            remedy='a TOML file with torque_constant and torques = "current" in [log] makes them '
            "torques (docs/robots.md)"
            if currents
            else "log the joints' torques or the motors' currents: every estimator needs them "
            "(didim does without velocities and accelerations, not without torques)",
            column="tau1",
        )


def _file(name: str) -> str:
    return name.rpartition("/")[2]


def misfit(table: Table, robot: Robot, columns: list[str]) -> str:
    """A remark on columns of joints that the robot does not have; empty if there are none.

    `columns` are those of the robot's joints. Refuses (exit status 65) a column whose unit is not
    that of the joint.
    """
    joints = len(robot.joints)
    for column in columns:
        _require_unit(table, robot, column)
    more = [
        column.replace(str(joints), str(joints + 1)) for column in columns[joints - 1 :: joints]
    ]
    if not any(column in table.columns for column in more):
        return ""
    return (
        f"warning: {table.name} has the column {more[0]}, but {robot.name} has only "
        f"{joints} joint{'s' if joints > 1 else ''}: is it another robot (--robot)?"
    )


def _require_unit(table: Table, robot: Robot, column: str) -> None:
    """Refuse a position or torque whose stated unit is not that of the joint."""
    name = column.removesuffix("_ref").rstrip("0123456789")
    unit = table.unit(column)
    if not unit or name not in ("q", "tau"):
        return
    number = int(column.removesuffix("_ref")[len(name) :])
    joint = robot.joints[number - 1]
    expected = joint.unit if name == "q" else joint.torque_unit
    if unit != expected:
        raise bad_data(
            table.name,
            f"unit {unit}",
            expected=f"{expected}, as joint {number} of {robot.name} is {joint.type}",
            remedy="state the robot of this table with --robot",
            column=column,
        )
