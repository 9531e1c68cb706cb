"""The declaration of `scarid export`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare


@declare("export")
@options.input_file(
    "--parameters",
    required=True,
    help="The parameter table of `scarid identify`.",
)
@options.robot
@click.option(
    "--to",
    "kind",
    type=click.Choice(("c",)),
    default="c",
    show_default=True,
    help="What to write: a C99 header.",
)
@click.option(
    "--name",
    default="robot",
    show_default=True,
    metavar="WORD",
    help="What the names of the functions begin with.",
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
@options.common
def command() -> None:
    """Write identified dynamics as code: gravity, inverse dynamics, mass matrix, friction.

    \b
      scarid export --parameters p.parquet --name arm -o arm.h
      scarid export --parameters p.parquet > robot.h

    The header is C99 without dependencies, for a controller: `arm_gravity(q, tau)`,
    `arm_inverse_dynamics(q, dq, ddq, tau)`, `arm_mass_matrix(q, M)` and `arm_friction(dq, tau)`,
    with the identified numbers in one structure. Its torques are those that `scarid validate`
    predicts, without the delay and without what identify fitted beside the parameters. For a
    simulator, which needs bodies that are physically possible, `scarid urdf` writes them.
    """
