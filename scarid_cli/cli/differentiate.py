"""scarid differentiate"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli import options
from scarid_cli.cli.described import describing


@click.command(name="differentiate", cls=describing(DIFFERENTIATORS, "Methods and their settings"))
@options.table_input
@click.option(
    "--method",
    type=click.Choice(DIFFERENTIATORS.names),
    help="How; see below.  [default: that of --settings, else kalman]",
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE[,VALUE...]",
    help="A setting of the method, one value for all joints or one per joint; repeatable.",
)
@click.option("--settings", "saved", metavar="FILE", help="Settings that scarid tune has saved.")
@click.option("--preset", metavar="NAME", help="Named settings; table1: as printed in the paper.")
@click.option(
    "--match/--no-match",
    default=None,
    help="Pass q and tau through the dynamics of the derivatives, so that all belong to the same "
    "instant, and mark rows at the ends that are not settled.  [default: match if the table has "
    "torques; the paper's procedure is --no-match]",
)
@options.table_output
@options.common
def command(
    file: str,
    method: str | None,
    settings: tuple[str, ...],
    saved: str | None,
    preset: str | None,
    match: bool | None,
    **rest: Any,
) -> None:
    """Estimate velocities and accelerations from positions (the soft sensor).

    \b
      scarid differentiate log.csv | scarid identify
      scarid tune log.csv --save kalman.toml; scarid differentiate --settings kalman.toml log.csv
      scarid differentiate --method p2smd --preset table1 --no-match log.csv
      scarid differentiate --method p2smd --set gamma0=25,40 --set gamma1=20,35 log.csv
      scarid filter --zero-phase --cutoff 20 log.csv | scarid differentiate --method central

    Adds dq1, dq2, ... and ddq1, ddq2, ... for every q1, q2, ... The defaults suit moves of a
    second at 200 Hz with a 16-bit encoder; those of p2smd, 2smd, astd and ed-fir are the paper's
    Table 1, or the nearest settings that work.

    --match also replaces q and tau, and adds the column settled: identify and validate leave out
    rows where it is 0. Linear methods are matched exactly in discrete time, the others by their
    linearisation or by measured delays; each method says which.

    Causal methods need no later sample. Methods of fixed lag delay each row, with its time, by
    the lag (in the metadata); methods of the whole record hold the whole log.
    """
    from scarid_cli.cli.job import job
    from scarid_cli.cli.methods import configured
    from scarid_cli.cli.settings import read
    from scarid_cli.io.schemas import joints_of
    from scarid_cli.stages import differentiate as stage

    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        table = run.read(file, "measurement")
        joints = joints_of(table.columns, "q")
        chosen, values = read(saved) if saved else ("kalman", {})
        name = method or chosen
        methods = configured(DIFFERENTIATORS, name, joints, settings, preset, values)
        table = run.recorded(table)
        if match is None:
            match = joints_of(table.columns, "tau") > 0
        if match:
            run.write(stage.matched(table, methods, run.left_out), out)
        else:
            run.write(stage.differentiate(table, methods, run.left_out), out)
