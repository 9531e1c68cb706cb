"""The declaration of `scarid validate`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.headings import DATA, OUTPUT, heading


@declare("validate")
@options.table_inputs
@heading(DATA)
@click.option(
    "--parameters",
    type=options.InputFile("apriori"),
    metavar="FILE",
    required=True,
    multiple=True,
    help="The parameter table that `scarid identify` wrote, or `apriori` for the a priori values "
    "(CAD) of the robot's description; repeatable: several are pooled.",
)
@options.robot
@selecting.selection
@options.treatment
@heading(OUTPUT)
@click.option(
    "--require",
    cls=options.Unrecorded,
    type=click.Choice(("unchanged",)),
    help="Exit with status 3 if the verdict is another one, or if there is none; the table is "
    "written all the same.",
)
@click.option(
    "--rollout",
    type=options.NUMBER,
    metavar="SECONDS",
    help="Also simulate: from measured states, the model moves by the measured torques for so "
    "long, and its positions are compared with the measured ones.",
)
@options.as_json
@options.side_output("--predictions", help="Write the measured and the predicted torques.")
@options.side_output(
    "--residual",
    help="Write the residual torque of each row, the band that it stays in, and the joint that is "
    "beyond it: a contact.",
)
@click.option(
    "--false-alarms",
    type=options.NUMBER,
    metavar="RATE",
    help="How often in an hour of motion --residual may call a contact by chance.  [default: 1]",
)
@click.option(
    "--observer",
    type=options.NUMBER,
    metavar="HZ",
    help="Let --residual take the residual of a momentum observer of this bandwidth, which needs "
    "no accelerations.  [default: that of the torques]",
)
@options.table_output
@options.common
def command() -> None:
    """Measure how well identified parameters predict the torques of a log.

    \b
      scarid validate --parameters parameters.parquet log.csv
      scarid validate --parameters p.parquet --predictions torques.parquet motion.parquet
      scarid validate --parameters may.parquet --parameters june.parquet july.csv
      scarid validate --parameters p.parquet --residual - -o metrics.csv motion.parquet

    The velocities and accelerations of a measurement (a log that has none) are estimated with the
    bandwidth of the identification, as far as the parameters state it, and the pipe that gives the
    same result is reported; this holds the log in memory. A motion is taken as it is.

    Writes for each joint R2 (paper eq. 36), the root-mean-square error (eq. 35), the relative error
    100 |tau - tau_hat| / |tau| in percent, and the number of samples. On the motion that the
    parameters were identified from, this is direct validation; on another motion, it is cross
    validation. Several logs count as one. Give the options that select and treat rows as they
    were given to identify. Several parameter tables are pooled, weighted by the information of
    their logs: the new log is then compared with all of these logs together.

    The verdict, on standard error and in the metadata, says whether the robot has changed since the
    identification: `unchanged`, `changed` with the cause (another payload or set-up, the friction,
    the motor constant or the offset of a joint, another delay, reversed or swapped joints), or
    `unexplained`. Of an unchanged robot that moves alike, at most one comparison in a hundred has
    another verdict by chance; on another kind of motion more may, as no model is exact. A change of
    the torques within the intervals that the identification states, and within 10 %, is named, but
    counts as `unchanged`. Parameters in a CSV file lack what
    the tests of delay and offsets need: write them as Parquet or Arrow.

    The band of --residual has two parts, whose squares add up: half the 95 % interval of the
    predicted torque at that row, and the level that the largest residuals of the identification's
    log, half a second each, pass as rarely as --false-alarms says. Rows that are left out, as near
    a reversal, are not judged. In a pipe, rows are written as they arrive.
    """
