"""The declaration of `scarid urdf`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare


@declare("urdf")
@click.argument("description", metavar="[ROBOT]", required=False, type=options.ROBOT)
@options.input_file(
    "--parameters",
    required=True,
    help="The parameter table of `scarid identify --robot ROBOT`; in Parquet or Arrow it carries "
    "the covariance of the estimates.",
)
@options.robot
@click.option(
    "--output",
    "-o",
    "place",
    cls=options.Unrecorded,
    default="-",
    metavar="FILE",
    help="Write the URDF to FILE.  [default: standard output]",
)
@options.side_output("--base", help="Write the base parameters of the new bodies as a table.")
@options.input_file(
    "--motion",
    help="Report R2 per joint on this motion, of the identified and of the consistent parameters. "
    "Give the options below as they were given to identify.",
)
@options.treatment
@options.common
def command() -> None:
    """Write identified parameters into a copy of a URDF as physically consistent link inertias.

    \b
      scarid urdf --parameters parameters.parquet arm.urdf -o identified.urdf
      scarid urdf --parameters p.parquet --motion motion.parquet arm.toml -o identified.urdf
      scarid urdf --parameters p.parquet --base near.csv arm.toml -o identified.urdf

    ROBOT is the URDF, or the TOML file that names it, as with --robot. Identified base parameters
    may belong to no real robot: a mass may come out negative, for example. This command computes
    physically consistent link inertias from them: positive masses and positive definite
    pseudo-inertias (Wensing, Kim, Slotine 2018), at the smallest Mahalanobis distance from the
    estimates. Of all such bodies it takes those closest to the bodies of the URDF. Parameters that
    `identify --essential` dropped stay at zero where positive masses allow it.

    The covariance of the estimates comes with a Parquet or Arrow table. CSV has none; the
    correlations are then neglected, which can ruin the prediction of torques: check with --motion.

    Viscous and Coulomb friction become damping and friction of the joints. What a URDF cannot hold
    (motor inertias, offsets, couplings) is written into a comment. This command needs an extra:
    pip install 'scarid[urdf]'.
    """
