"""The declaration of `scarid differentiate`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.described import listed, recommended
from scarid_cli.cli.declaring.headings import METHOD, heading


@declare("differentiate")
@options.table_input
@heading(METHOD)
@click.option(
    "--method",
    type=click.Choice(DIFFERENTIATORS.names),
    metavar="NAME",
    help=f"The method: {listed(DIFFERENTIATORS)}. `scarid methods NAME` describes one. "
    f"Recommended: {recommended(DIFFERENTIATORS)}.  "
    "[default: the best of --settings, else kalman]",
)
@click.option(
    "--set",
    "given",
    multiple=True,
    metavar="NAME=VALUE[,VALUE...]",
    shell_complete=options.offered("settings"),
    help="A setting of the method, one value for all joints or one per joint; repeatable.",
)
@options.input_file("--settings", help="Settings that `scarid tune --save` wrote.")
@click.option(
    "--preset",
    metavar="NAME",
    shell_complete=options.offered("presets"),
    help="Named settings; table1 is that of the paper.",
)
@click.option(
    "--match/--no-match",
    default=None,
    help="Bring all signals of a row to the same instant, and mark the settling rows.  [default: "
    "--match if the table has torques; the paper's procedure is --no-match]",
)
@click.option(
    "--per-joint",
    is_flag=True,
    help="Allow settings that differ between joints together with --match, for joints that move "
    "independently: a torque of an arm contains the accelerations of all joints.",
)
@click.option(
    "--velocity",
    type=click.Choice(("estimated", "measured")),
    metavar="ORIGIN",
    help="`measured` takes the velocities of the log (dq1 or dq1_measured, ...) behind the "
    "low-pass of the method, and differentiates these.  [default: estimated from the positions]",
)
@selecting.selection
@options.table_output
@options.common
def command() -> None:
    """Estimate velocities and accelerations from positions (the soft sensor).

    \b
      scarid differentiate log.csv | scarid identify
      scarid tune --robot scara2 log.csv --save log.toml
      scarid differentiate --settings log.toml log.csv
      scarid differentiate --method p2smd --preset table1 --no-match log.csv
      scarid differentiate --method p2smd --set gamma0=25 --set gamma1=20 log.csv
      scarid filter --zero-phase --cutoff 20 log.csv | scarid differentiate --method central

    Adds the columns dq1, dq2, ... and ddq1, ddq2, ... for the positions q1, q2, ... Velocities
    that the log has are kept as dq1_measured, ... The default settings suit moves that take a
    second, sampled at 200 Hz with a 16-bit encoder.

    --match passes q and tau through the dynamics of the derivatives and adds the column settled;
    identify and validate leave out the rows where it is 0. Methods with a fixed lag delay each row,
    together with its time. Methods of the whole record hold the log in memory.
    """
