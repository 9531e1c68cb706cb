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
    help="The differentiator to tune; all tunes every causal one.",
)
@click.option(
    "--robot",
    type=options.ROBOT,
    metavar="NAME|FILE",
    help="Judge settings by the torques predicted for this robot (see identify --robot).",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the search."
)
@options.side_output("--save", help="Write the settings for differentiate --settings.")
@options.table_output
@options.common
def command() -> None:
    """Find the settings of differentiators from a log, without knowing the truth.

    \b
      scarid tune log.csv --save kalman.toml
      scarid differentiate --settings kalman.toml log.csv
      scarid tune --method all log.csv | sort -t, -k5 -g | column -s, -t
      scarid tune --method p2smd --robot scara2 log.csv --save p2smd.toml

    The Kalman methods are given the noise, the intensity and the acceleration process under which
    the positions are most likely, for each joint separately. The settings of other methods are
    those whose derivatives are nearest to a Kalman smoother that tuned itself in this way: unlike
    them, it has seen what follows each sample. With --robot all joints share one setting, and
    settings are judged by the torques predicted for held-out segments, with parameters identified
    from the others. Holds the whole log in memory; of a log with gaps, the longest segment is used.

    Writes the table of all settings that were tried. The same seed gives the same settings.
    """
