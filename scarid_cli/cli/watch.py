"""The declaration of `scarid watch`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.headings import DATA, METHOD, OUTPUT, heading


@declare("watch")
@options.table_inputs
@heading(DATA)
@options.robot
@heading(METHOD)
@click.option(
    "--forgetting",
    metavar="FACTOR[,NAME=FACTOR...]",
    shell_complete=options.offered("parameters"),
    help="Forgetting factor per sample, followed by other factors for single parameters.  "
    "[default: 1]",
)
@click.option(
    "--initial",
    type=options.InputFile("apriori"),
    metavar="FILE",
    help="Initial parameters: a parameter table, or `apriori` for the a priori values of the "
    "robot.  [default: zeros]",
)
@options.treatment
@heading(OUTPUT)
@click.option(
    "--every",
    type=options.NUMBER,
    metavar="SECONDS",
    default=1.0,
    show_default=True,
    help="Time between the lines where standard error is no terminal.",
)
@click.option(
    "--require",
    cls=options.Unrecorded,
    type=click.Choice(("good", "rough", "not-biased", "identifiable")),
    help="Exit with status 3 if the verdict at the end is worse; the table is written all the "
    "same.",
)
@options.side_output("--trace", help="Write the estimates after every sample.")
@options.table_output
@options.common
def command() -> None:
    """Watch the estimates of a robot that moves, at the end of a live pipe.

    \b
      scarid listen --port 5000 --idle 1 --split then differentiate then watch --robot scara2
      scarid trajgen --duration 2 | scarid simulate --realtime | scarid differentiate | scarid watch
      scarid listen --follow log.csv --idle 1 then differentiate then watch --robot arm.toml

    Shows each estimate with half its 95 % interval, the verdict so far, the rows that have come and
    how many a second, the age of the last one, how much later it came than the one that came
    soonest, and what was lost. A terminal is drawn anew five times a second; elsewhere there is a
    line every --every seconds.

    The estimates are those of `scarid identify` after every batch of rows (recursive least
    squares). Intervals and verdict are those of `identify` as well; they take longer, and are
    renewed as often as they cost a twentieth of the time. Ctrl-C, `kill` or the end of the input
    end the table of parameters, which is then written as `identify` writes it, with the same
    verdict and exit status.
    """
