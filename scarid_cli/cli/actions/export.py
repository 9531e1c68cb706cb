"""Run `scarid export`."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import pyarrow as pa

from scarid_cli.algorithms.plants.definite import indefinite
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.files import text_of
from scarid_cli.algorithms.robots.physical import Physical
from scarid_cli.algorithms.robots.reading import path_of
from scarid_cli.cli.declaring.belonging import the_robot
from scarid_cli.cli.running.command_line import command_line
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Table
from scarid_cli.stages import urdf
from scarid_cli.stages.export import c_header, identifier, matlab_class
from scarid_cli.stages.models.described import described, lost
from scarid_cli.stages.models.intervals import Interval, intervals, listed
from scarid_cli.stages.models.mjcf import mjcf
from scarid_cli.stages.models.modelled import modelled
from scarid_cli.stages.results.estimates import Estimates, estimates_with_covariance
from scarid_cli.stages.results.parameters import identified

OF_BODIES = ("urdf", "mjcf", "json")


def run(
    job: Job,
    *,
    description: str | None,
    parameters: str,
    robot: str | None,
    kind: str,
    name: str,
    place: str,
    base: str | None,
) -> None:
    """Write the model, and say what it lacks of what was identified."""
    stated = the_robot(description, robot)
    if base and kind not in OF_BODIES:
        raise UsageFault(f"--base: {kind} has no bodies of its own; it is for urdf, mjcf and json")
    out, side = job.text(place), job.side_table(base)
    table = job.read(parameters, "parameters")
    source = Source(job, table, list(table.batches), job.robot(stated, table), name, place)
    for note in identified(source.table, source.robot).left_out:
        job.say(f"warning: the {kind} file has the parameters alone, and lacks: {note}")
    if kind not in OF_BODIES and source.doubt:
        job.say(source.doubt)
    out.write(WRITERS[kind](source))
    if side:
        job.write(job.recorded(urdf.base_table(table, source.estimates, source.bodies)), side)


@dataclass
class Source:
    """What the writers need, computed when they ask for it."""

    job: Job
    read: Table
    batches: list[pa.RecordBatch]
    robot: Robot
    name: str
    place: str

    @property
    def table(self) -> Table:
        """The table of parameters, as often as it is wanted."""
        return replace(self.read, batches=iter(self.batches))

    @property
    def rows(self) -> list[Interval]:
        """The parameters with their intervals."""
        return intervals(self.table)

    @cached_property
    def estimates(self) -> Estimates:
        """The estimates with their covariance, which the nearest bodies need."""
        return estimates_with_covariance(self.table, self.robot)

    @cached_property
    def doubt(self) -> str:
        """A warning, if no robot has the mass matrix of the parameters as they are."""
        found = identified(self.table, self.robot)
        values = dict(zip(found.robot.names, found.theta.tolist(), strict=True))
        impossible = indefinite(found.robot.with_values(values))
        return f"warning: {impossible.text}" if impossible else ""

    @property
    def notes(self) -> list[str]:
        """What code says at its top: the intervals of the parameters."""
        return [*([self.doubt, ""] if self.doubt else []), *listed(self.rows)]

    @cached_property
    def bodies(self) -> Physical:
        """The physically consistent bodies, which are told of."""
        found = urdf.physical(self.estimates)
        for line in urdf.consistency_report(self.estimates, found):
            self.job.say(line)
        return found

    def urdf_text(self) -> str:
        """The URDF of the robot."""
        if not self.robot.body:
            raise UsageFault(f"{self.robot.name}: has no URDF to write parameters into")
        return text_of(self.robot.body.path)


def _urdf(source: Source) -> str:
    text, found = source.urdf_text(), source.bodies
    for line in urdf.held_report(source.robot, found):
        source.job.say(line)
    notes = listed(source.rows, found.base)
    return urdf.document(text, source.robot, found, command_line(), notes)


def _mjcf(source: Source) -> str:
    text, found = source.urdf_text(), source.bodies
    written, remarks = mjcf(text, source.robot, found, command_line(), source.rows)
    for remark in remarks:
        source.job.say(remark)
    return written


def _toml(source: Source) -> str:
    robot = source.robot
    for name in lost(robot):
        source.job.say(f"warning: {name} is left out; a robot with a URDF has no term for it")
    text = None if robot.name.endswith(".urdf") else text_of(path_of(robot.name))
    folder = "" if source.place == "-" else str(Path(source.place).parent)
    return described(text, robot, source.rows, command_line(), folder)


def _json(source: Source) -> str:
    found = source.bodies if source.robot.body else None
    document = modelled(source.table, source.robot, found, source.rows)
    return json.dumps(document, indent=2, allow_nan=False) + "\n"


def _c(source: Source) -> str:
    found = identified(source.table, source.robot)
    return c_header(found, source.name, command_line(), source.notes)


def _matlab(source: Source) -> str:
    if source.place != "-" and Path(source.place).stem != identifier(source.name):
        source.job.say(
            f"warning: MATLAB looks for the class {identifier(source.name)} in a file of that "
            "name; state another one with --name"
        )
    found = identified(source.table, source.robot)
    return matlab_class(found, source.name, command_line(), source.notes)


WRITERS: dict[str, Callable[[Source], str]] = {
    "urdf": _urdf,
    "mjcf": _mjcf,
    "toml": _toml,
    "json": _json,
    "c": _c,
    "matlab": _matlab,
}
