"""The declaration of `scarid differentiate`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli import options, selecting
from scarid_cli.cli.declare import declare
from scarid_cli.cli.described import describing


@declare("differentiate", describing(DIFFERENTIATORS, "Methods", brief=True))
@options.table_input
@click.option(
    "--method",
    type=click.Choice(DIFFERENTIATORS.names),
    help="The method; see below.  [default: the best of --settings, else kalman]",
)
@click.option(
    "--set",
    "given",
    multiple=True,
    metavar="NAME=VALUE[,VALUE...]",
    help="A setting of the method, one value for all joints or one per joint; repeatable.",
)
@options.input_file(
    "--settings", help="Settings that `scarid tune --save` wrote, one value per joint."
)
@click.option(
    "--preset", metavar="NAME", help="Named settings; table1 has those printed in the paper."
)
@click.option(
    "--match/--no-match",
    default=None,
    help="Pass positions and torques through the dynamics of the derivatives, so that all signals "
    "of a row belong to the same instant, and mark the settling rows.  [default: --match if the "
    "table has torques; the paper's procedure is --no-match]",
)
@click.option(
    "--per-joint",
    is_flag=True,
    help="Allow settings that differ between joints together with --match. A torque contains the "
    "accelerations of all joints of an arm, so this suits only joints that move independently.",
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

    Adds the columns dq1, dq2, ... and ddq1, ddq2, ... for the positions q1, q2, ... The default
    settings suit moves that take a second, sampled at 200 Hz with a 16-bit encoder. Those of p2smd,
    2smd, astd and ed-fir are the paper's Table 1, or the nearest settings that work.

    --match replaces q and tau as well and adds the column settled; identify and validate leave
    out the rows where it is 0. Linear methods are matched exactly in discrete time, the others
    through their linearisation or by measured delays; each method says which.

    Causal methods need no later samples. Methods with a fixed lag delay each row, together with its
    time, by that lag, which the metadata state. Methods of the whole record hold the whole log in
    memory.
    """
