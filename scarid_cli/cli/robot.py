"""scarid robot check"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

import click

from scarid_cli.cli.declaring import options
from scarid_cli.printable import printable

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.capsules import Capsule
    from scarid_cli.algorithms.robots.description import Robot
    from scarid_cli.algorithms.robots.joints import Joint
    from scarid_cli.algorithms.robots.logs import LogFormat
    from scarid_cli.algorithms.robots.rigid import Body


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
    For a robot with a URDF it also shows which joints are locked and why, the link of the tool, the
    shapes that are kept apart (see `scarid trajgen --optimise`), and the combination of standard
    parameters that each base parameter stands for.
    """
    from scarid_cli.algorithms.robots.reading import load

    for line in described(load(robot)):
        click.echo(printable(line))


def _contents(log: LogFormat) -> str:
    """What the logs of the robot hold."""
    from scarid_cli.algorithms.robots.logs import CURRENT

    parts = [f"positions of {log.positions}s"]
    parts.append("currents of motors" if log.torques == CURRENT else f"torques of {log.torques}s")
    parts += [f"{new} is {old}" for new, old in log.columns.items()]
    parts += [f"{pattern} in {unit}" for pattern, unit in log.units]
    parts += [f"{log.rate:g} Hz"] if log.rate else []
    parts += [f"joint {i} at {x:g} where they have 0" for i, x in enumerate(log.zero, 1) if x]
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


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{x:g}" for x in values)


def _shape(capsule: Capsule) -> str:
    """The sphere or capsule, in the frame of its link."""
    if capsule.start == capsule.end:
        return f"sphere at {_numbers(capsule.start)} m, radius {capsule.radius:g} m"
    ends = f"{_numbers(capsule.start)} to {_numbers(capsule.end)}"
    return f"capsule from {ends} m, radius {capsule.radius:g} m"


def described(robot: Robot) -> Iterator[str]:
    """The lines on the robot, each of its joints and each of its parameters."""
    yield from _summary(robot)
    yield "joints"
    for i, joint in enumerate(robot.joints, start=1):
        yield f"  {i}  {joint.type:<9}  {', '.join(_limits(joint)) or 'no limits'}"
    if robot.body:
        yield from _links(robot.body)
    yield from _imperfections(robot)
    yield "parameters"
    width = max(len(parameter.name) for parameter in robot.parameters)
    for parameter in robot.parameters:
        more = f"  = {parameter.stands_for}" if parameter.stands_for else ""
        line = f"  {parameter.name:<{width}}  {parameter.unit:<9}  {parameter.apriori:g}{more}"
        yield line.rstrip()


def _summary(robot: Robot) -> Iterator[str]:
    joints, parameters = len(robot.joints), len(robot.parameters)
    yield f"robot       {robot.name}: {robot.title}"
    yield f"freedom     {joints} joint{'s' if joints > 1 else ''}, {parameters} parameters"
    controller = robot.control.kind if robot.control else "none; `simulate` uses its default"
    yield f"controller  {controller}"
    if robot.body:
        yield f"gravity     {_numbers(robot.body.gravity)} m/s2"
        yield f"tool        {robot.body.tool}"
    if robot.log:
        yield f"logs        {_contents(robot.log)}"


def _links(body: Body) -> Iterator[str]:
    """The joints that are locked, and the shapes of the links."""
    for doubt in body.doubts:
        yield f"  warning: {doubt}"
    for text in body.followers:
        yield f"  follows: {text}"
    for name, why in body.locked.items():
        at = dict(body.posture).get(name)
        yield f"  locked: {name} ({why})" + (f" at {at:g}" if at is not None else "")
    if body.capsules:
        yield "shapes of the links"
    for capsule in body.capsules:
        yield f"  {capsule.link}: {_shape(capsule)}"


def _imperfections(robot: Robot) -> Iterator[str]:
    from scarid_cli.algorithms.imperfections.registry import written

    if robot.imperfections:
        yield "imperfections of the simulated robot"
    for name, values in robot.imperfections.items():
        yield f"  {written(name, values)}"
