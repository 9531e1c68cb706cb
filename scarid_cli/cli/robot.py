"""scarid robot check"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import TYPE_CHECKING, Any

import click

from scarid_cli.cli import options

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot
    from scarid_cli.algorithms.robots.joints import Joint
    from scarid_cli.algorithms.robots.logs import LogFormat


@click.group(name="robot")
def command() -> None:
    """Check robot descriptions.

    \b
      scarid robot check scara2
      scarid robot check arm.urdf
    """


@command.command(name="check")
@click.argument("robot", metavar="ROBOT", type=options.ROBOT)
@options.common
def check(robot: str, **_rest: Any) -> None:
    """Show how scarid interprets a robot description.

    \b
      scarid robot check planar2-gravity
      scarid robot check mine.toml

    ROBOT is the name of a robot that comes with scarid (scara2, emps, planar2-gravity), a TOML file
    or a URDF. The command shows what the logs of the robot hold (see `scarid convert --robot`), its
    joints with their limits, the imperfections of the simulated robot (see `scarid simulate
    --with`), and the parameters that `scarid identify` estimates: name, unit and a priori value.
    For a robot with a URDF it also shows which joints are locked and why, and the combination of
    standard parameters that each base parameter stands for.
    """
    from scarid_cli.algorithms.robots.reading import load

    for line in described(load(robot)):
        click.echo(line)


def _contents(log: LogFormat) -> str:
    """What the logs of the robot hold."""
    from scarid_cli.algorithms.robots.logs import CURRENT

    parts = [f"positions of {log.positions}s"]
    parts.append("currents of motors" if log.torques == CURRENT else f"torques of {log.torques}s")
    parts += [f"{new} is {old}" for new, old in log.columns.items()]
    parts += [f"{pattern} in {unit}" for pattern, unit in log.units]
    parts += [f"{log.rate:g} Hz"] if log.rate else []
    return ", ".join(parts)


def _limits(joint: Joint) -> Iterator[str]:
    """The limits that the description gives."""
    if isfinite(joint.lower) or isfinite(joint.upper):
        yield f"position {joint.lower:g} to {joint.upper:g} {joint.unit}"
    for name, limit, unit in (
        ("velocity", joint.velocity_limit, f"{joint.unit}/s"),
        ("acceleration", joint.acceleration_limit, f"{joint.unit}/s2"),
        ("torque", joint.torque_limit, joint.torque_unit),
    ):
        if isfinite(limit):
            yield f"{name} {limit:g} {unit}"


def described(robot: Robot) -> Iterator[str]:
    """The lines on the robot, each of its joints and each of its parameters."""
    from scarid_cli.algorithms.imperfections.registry import written

    joints, parameters = len(robot.joints), len(robot.parameters)
    yield f"robot       {robot.name}: {robot.title}"
    yield f"freedom     {joints} joint{'s' if joints > 1 else ''}, {parameters} parameters"
    controller = robot.control.kind if robot.control else "none; `simulate` uses its default"
    yield f"controller  {controller}"
    if robot.body:
        yield f"gravity     {' '.join(f'{x:g}' for x in robot.body.gravity)} m/s2"
    if robot.log:
        yield f"logs        {_contents(robot.log)}"
    yield "joints"
    for i, joint in enumerate(robot.joints, start=1):
        yield f"  {i}  {joint.type:<9}  {', '.join(_limits(joint)) or 'no limits'}"
    for name, why in (robot.body.locked if robot.body else {}).items():
        yield f"  locked: {name} ({why})"
    if robot.imperfections:
        yield "imperfections of the simulated robot"
    for name, values in robot.imperfections.items():
        yield f"  {written(name, values)}"
    yield "parameters"
    width = max(len(parameter.name) for parameter in robot.parameters)
    for parameter in robot.parameters:
        more = f"  = {parameter.stands_for}" if parameter.stands_for else ""
        line = f"  {parameter.name:<{width}}  {parameter.unit:<9}  {parameter.apriori:g}{more}"
        yield line.rstrip()
