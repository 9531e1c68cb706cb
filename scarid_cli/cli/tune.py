"""The declaration of `scarid tune`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli import options
from scarid_cli.cli.declare import declare


@declare("tune")
@options.table_input
@click.option(
    "--method",
    type=click.Choice(["all", *DIFFERENTIATORS.names]),
    default="kalman",
    show_default=True,
    help="The differentiator to tune; `all` tunes every causal one.",
)
@click.option(
    "--robot",
    type=options.ROBOT,
    metavar="NAME|FILE",
    help="Judge settings by the predicted torques of this robot (see identify --robot).",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the search."
)
@options.side_output("--save", help="Write the best settings, for differentiate --settings.")
@options.table_output
@options.common
def command() -> None:
    """Find the settings of differentiators from a log, without knowing the truth.

    \b
      scarid tune log.csv --save kalman.toml
      scarid differentiate --settings kalman.toml log.csv
      scarid tune --method all log.csv | sort -t, -k5 -g | column -s, -t
      scarid tune --method p2smd --robot scara2 log.csv --save p2smd.toml

    For the Kalman methods, the noise, the intensity and the acceleration process of each joint are
    found by maximum likelihood. The other methods get the settings whose derivatives come closest
    to those of a Kalman smoother that is tuned in this way; it serves as the reference because it
    also uses the samples after each row. With --robot, all joints share their settings, which are
    judged by how well they predict the torques of held-out segments of the log, with parameters
    identified from the remaining segments.

    Writes the table of all settings that were tried. The same seed gives the same settings. Holds
    the whole log in memory; if the log has gaps, only its longest segment is used.
    """
