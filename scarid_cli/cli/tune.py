"""scarid tune"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.cli import options


@click.command(name="tune")
@options.table_input
@click.option(
    "--method",
    type=click.Choice(["all", *DIFFERENTIATORS.names]),
    default="kalman",
    show_default=True,
    help="Which differentiator; all: every causal one.",
)
@click.option(
    "--robot",
    metavar="NAME|FILE",
    help="Judge by the torques predicted for this robot (see identify --robot).",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Of the search.")
@click.option("--save", metavar="FILE", help="Write the settings for differentiate --settings.")
@options.table_output
@options.common
def command(
    file: str, method: str, robot: str | None, seed: int, save: str | None, **rest: Any
) -> None:
    """Find settings of differentiators in a log, without the truth.

    \b
      scarid tune log.csv --save kalman.toml
      scarid differentiate --settings kalman.toml log.csv
      scarid tune --method all log.csv | sort -t, -k5 -g | column -s, -t
      scarid tune --method p2smd --robot scara2 log.csv --save p2smd.toml

    The Kalman methods get the noise, the intensity and the acceleration process that make the
    positions most likely, each joint for itself. The others come as near as they can to the
    derivatives of a Kalman smoother that tuned itself in this way: it has seen the future of each
    sample. With --robot the settings are one for all joints, and judged by the torques predicted
    for held-out segments with parameters identified from the rest. Holds the whole log; of one
    with gaps, the longest segment counts.

    Writes the table of what was tried. The same seed gives the same settings.
    """
    from scarid_cli.cli.job import command_line, job, robot_of
    from scarid_cli.cli.progress import steps
    from scarid_cli.cli.settings import document
    from scarid_cli.io.reader import require
    from scarid_cli.io.schemas import joints_of
    from scarid_cli.stages import tune as stage

    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        side = run.text(save) if save else None
        table = run.recorded(run.read(file, "measurement"))
        arm = robot_of(robot) if robot else None
        joints = len(arm.joints) if arm else joints_of(table.columns, "q")
        numbers = range(1, joints + 1)
        if arm:
            columns = [f"{signal}{i}" for signal in ("q", "tau") for i in numbers]
            require(table, columns, f"this one for robot {arm.name}")
        names = stage.online() if method == "all" else [method]
        record = stage.Record.of(table, joints, torques=arm is not None)
        with steps(quiet=rest["quiet"]) as progress:
            rows = stage.tune(record, names, arm, seed, progress)
        best, settings = stage.chosen(rows, joints)
        run.write(stage.trials(table, rows), out)
        if side:
            side.write(document(best, settings, command_line()))
        for row in rows:
            if row.best and row.judge != stage.LIKELIHOOD and row.name == best:
                where = f"joint {row.joint}, " if row.joint else ""
                run.say(f"{best}, {where}{row.judge} {row.trial.loss:.4g}: {row.settings}")
