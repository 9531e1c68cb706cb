"""The declaration of `scarid export`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare

KINDS = ("urdf", "mjcf", "toml", "json", "c", "matlab")


@declare("export")
@click.argument("description", metavar="[ROBOT]", required=False, type=options.ROBOT)
@options.input_file(
    "--parameters",
    required=True,
    help="The parameter table of `scarid identify`; in Parquet or Arrow it carries the covariance "
    "of the estimates, which urdf, mjcf and json need.",
)
@options.robot
@click.option(
    "--to",
    "kind",
    type=click.Choice(KINDS),
    default="c",
    show_default=True,
    help="What to write (see above).",
)
@click.option(
    "--name",
    default="robot",
    show_default=True,
    metavar="WORD",
    help="What the names of the functions in C begin with; the name of the class in MATLAB.",
)
@click.option(
    "--output",
    "-o",
    "place",
    cls=options.Unrecorded,
    default="-",
    metavar="FILE",
    help="Write to FILE.  [default: standard output]",
)
@options.side_output(
    "--base",
    help="Of urdf, mjcf and json: write the base parameters of the new bodies as a table, which "
    "`scarid validate` takes.",
)
@options.common
def command() -> None:
    """Write identified dynamics for controllers and simulators: C, MATLAB, MJCF, URDF, TOML, JSON.

    \b
      scarid export --parameters p.parquet --name arm -o arm.h
      scarid export --to matlab --parameters p.parquet --name arm -o arm.m
      scarid export --to mjcf --parameters p.parquet arm.toml -o arm.xml
      scarid export --to toml --parameters p.parquet arm.toml -o identified.toml
      scarid export --to json --parameters p.parquet arm.toml > identified.json

    ROBOT is the robot of the parameters, as with --robot. Each file has the 95 % interval of every
    parameter.

    \b
    c       a C99 header without dependencies, for a controller: gravity,
            inverse dynamics, mass matrix and friction, with the numbers in
            one structure
    matlab  the same as a class with static functions: tau = arm.gravity(q)
    toml    the description with a table [estimates], which every command
            reads: `simulate --robot` then moves the identified robot
    urdf    the file of `scarid urdf`: possible bodies, friction, motors
    mjcf    the same bodies for MuJoCo, with armature, damping, frictionloss,
            gears and offsets; needs pip install 'scarid[sim,urdf]'
    json    parameters, bodies and drives of each link and axis, by a schema

    The torques of c, matlab and toml are those that `scarid validate` predicts, without the delay
    and without what identify fitted beside the parameters. Bodies that are physically possible have
    slightly other ones: those that it predicts with the table of --base.
    """
