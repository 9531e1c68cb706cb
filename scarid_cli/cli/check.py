"""The declaration of `scarid check`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare


@declare("check")
@options.table_input
@options.robot
@click.option("--strict", is_flag=True, help="Exit with 1 if there are warnings only.")
@click.option(
    "--fix", is_flag=True, help="Print the pipe that mends what it can, and nothing else."
)
@selecting.window
@options.as_json
@options.common
def command() -> None:
    """Check a log before it is identified: its clock, values, units, motion and torques.

    \b
      scarid check --robot arm.toml log.csv
      eval "$(scarid check --fix log.csv)" > mended.csv
      scarid check --strict log.parquet && scarid identify log.parquet
      scarid check --json log.csv | jq -r '.checks[] | select(.status != "ok") | .advice'

    The log has time, positions and torques, as for `scarid identify`, but its clock may jitter and
    values may be missing. Each line is a check: ok, warning or failed, what was found, and below it
    what to do. Units, reversed torques and exchanged joints are found with the limits of the
    robot's description and with a first fit of its model, which needs no parameters. A fault
    that one check finds is corrected before the next ones run. Below the count stands the pipe that
    mends what commands can mend. The log is held in memory.

    Exit status: 0, also with warnings; 1 if there are warnings only and --strict is given; 65 if a
    check failed, with --fix if the pipe leaves something that failed.
    """
