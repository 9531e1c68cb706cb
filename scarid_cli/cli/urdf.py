"""The declaration of `scarid urdf`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare


@declare("urdf")
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
    "place",
    cls=options.Unrecorded,
    default="-",
    metavar="FILE",
    help="Where the URDF goes.  [default: stdout]",
)
@options.side_output("--base", help="Write the base parameters of the new bodies as a table.")
@options.common
def command() -> None:
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
