"""The declaration of `scarid tune`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("tune")
@options.table_input
@click.option(
    "--method",
    "methods",
    multiple=True,
    type=click.Choice(["all", *DIFFERENTIATORS.names]),
    metavar="NAME",
    help="A method of `scarid differentiate` to tune, repeatable; `all` stands for every causal "
    "one. The first is what differentiate --settings uses.  [default: rts and kalman with --robot, "
    "else kalman]",
)
@click.option(
    "--robot",
    type=options.ROBOT,
    metavar="NAME|FILE",
    help="Choose the bandwidth at which estimates of this robot agree best (see identify --robot).",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of a search."
)
@options.side_output("--save", help="Write the chosen settings, for differentiate --settings.")
@selecting.selection
@options.table_output
@options.common
def command() -> None:
    """Find the settings of differentiators from a log, without knowing the truth.

    \b
      scarid tune --robot scara2 log.csv --save log.toml
      scarid differentiate --settings log.toml log.csv
      scarid tune --robot scara2 --to-time 10 --method kalman log.csv --save online.toml
      scarid tune log.csv --save kalman.toml
      scarid tune --method all log.csv | sort -t, -k4 -g | column -s, -t

    With --robot, positions and torques of all joints pass one zero-phase low-pass after another,
    from low to high cut-offs, and parameters are identified behind each. The cut-off is chosen in
    the middle of the range in which the parameters of the parts of the log scatter least. Each
    method then gets the settings that have this bandwidth. A method without a bandwidth, such as a
    sliding-mode differentiator, gets the settings whose derivatives come closest to those of the
    smoother with this bandwidth.

    Without a robot only the positions are used. For the Kalman methods, the noise, the intensity
    and the acceleration process are found by maximum likelihood, the noise being at least that of
    the encoder's resolution. The other methods get the settings whose derivatives come closest to
    those of Kalman smoothers that tune themselves. Vibrations of the arm count as motion here, so
    that a robot with torques is better tuned with --robot.

    All joints get the same settings, because a torque contains the accelerations of all joints.
    Writes the table of all settings that were tried. The same seed gives the same settings. Holds
    the log in memory. Without a robot, only the longest segment of a log with gaps is used.
    """
