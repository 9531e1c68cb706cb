"""scarid urdf"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="urdf")
@click.argument("robot", metavar="ROBOT", type=options.ROBOT)
@click.option(
    "--parameters",
    required=True,
    type=options.INPUT,
    metavar="FILE",
    help="The parameter table that `scarid identify --robot ROBOT` made.",
)
@click.option(
    "--output",
    "-o",
    cls=options.Unrecorded,
    default="-",
    metavar="FILE",
    help="Where the URDF goes.  [default: stdout]",
)
@options.side_output("--base", help="Write the base parameters of the new bodies as a table.")
@options.common
def command(robot: str, parameters: str, output: str, base: str | None, **rest: Any) -> None:
    """Put identified parameters into a copy of a URDF, as bodies that can exist.

    \b
      scarid urdf --parameters parameters.csv arm.urdf -o identified.urdf
      scarid urdf --parameters p.csv --base near.csv arm.toml -o identified.urdf
      scarid validate --robot arm.toml --parameters near.csv motion.csv

    ROBOT is the URDF, or the TOML file that names it. Identified base parameters may belong to no
    body that exists: with a negative mass, say. They are moved by as few of their errors as
    positive masses and positive definite pseudo-inertias need (Wensing, Kim, Slotine 2018), and of
    all bodies with these base parameters those next to the URDF's own are taken. Viscous and dry
    friction become damping and friction of the joints; what a URDF has no place for (motor
    inertias, offsets, couplings) is in a comment. Needs the extra: pip install 'scarid[urdf]'.
    """
    from pathlib import Path

    from scarid_cli.algorithms.robots.reading import load
    from scarid_cli.cli.job import command_line, job
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import urdf as stage

    arm = load(robot)
    if not arm.body:
        raise UsageFault(f"{robot}: has no URDF to put parameters into")
    with job(rest) as run:
        out = run.text(output)
        side = run.output(base) if base else None
        known = run.read(parameters, "parameters")
        found = stage.physical(known, arm)
        out.write(
            stage.document(Path(arm.body.path).read_text("utf-8"), arm, found, command_line())
        )
        if side:
            run.write(run.recorded(stage.base_table(known, arm, found)), side)
        for line in stage.told(arm, found):
            run.say(line)
