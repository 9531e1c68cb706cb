"""scarid differentiate"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.algorithms.registry import DIFFERENTIATORS
from scarid_cli.cli import options


class MethodsCommand(click.Command):
    """A command whose help ends with the description of every method."""

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Methods and their settings"):
            for name in DIFFERENTIATORS.names:
                formatter.write(f"{' ' * formatter.current_indent}{name}\n")
                for line in DIFFERENTIATORS.describe(name).splitlines():
                    formatter.write(f"{' ' * (formatter.current_indent + 2)}{line}".rstrip() + "\n")
                formatter.write_paragraph()


@click.command(name="differentiate", cls=MethodsCommand)
@options.table_input
@click.option(
    "--method",
    type=click.Choice(DIFFERENTIATORS.names),
    default="p2smd",
    show_default=True,
    help="How; see below.",
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE[,VALUE...]",
    help="A setting of the method, one value for all joints or one per joint; repeatable.",
)
@click.option("--preset", metavar="NAME", help="Named settings; table1: as printed in the paper.")
@click.option(
    "--match/--no-match",
    default=False,
    help="Pass q and tau through the dynamics of the derivatives, so that all belong to the same "
    "instant.  [default: no-match, the paper's procedure]",
)
@options.table_output
@options.common
def command(
    file: str,
    method: str,
    settings: tuple[str, ...],
    preset: str | None,
    match: bool,
    **rest: Any,
) -> None:
    """Estimate velocities and accelerations from positions (the soft sensor).

    \b
      scarid differentiate --method p2smd --match log.csv
      scarid differentiate --method p2smd --set gamma0=25,40 --set gamma1=20,35 log.csv
      scarid differentiate --method 2smd --preset table1 log.csv
      scarid filter --zero-phase --cutoff 20 log.csv | scarid differentiate --method central

    Adds dq1, dq2, ... and ddq1, ddq2, ... for every q1, q2, ... The defaults are the paper's
    Table 1, or the nearest settings that work at 200 Hz.
    """
    from scarid_cli.cli.job import job
    from scarid_cli.cli.methods import configured
    from scarid_cli.io.schemas import joints_of
    from scarid_cli.stages import differentiate as stage

    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        table = run.read(file, "measurement")
        joints = joints_of(table.columns, "q")
        methods = configured(DIFFERENTIATORS.load(method), method, joints, settings, preset)
        table = run.recorded(table)
        if match:
            run.write(stage.matched(table, methods), out)
        else:
            run.write(stage.differentiate(table, methods), out)
