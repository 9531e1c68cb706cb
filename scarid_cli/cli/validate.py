"""The declaration of `scarid validate`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare


@declare("validate")
@options.table_input
@click.option(
    "--parameters",
    required=True,
    type=options.INPUT,
    metavar="FILE",
    help="The parameter table of `scarid identify`.",
)
@options.robot
@options.treatment
@options.side_output("--predictions", help="Write measured and predicted torques.")
@options.table_output
@options.common
def command() -> None:
    """Predict torques with identified parameters, and measure how well.

    \b
      scarid validate --parameters parameters.csv motion.csv
      scarid validate --parameters p.parquet --predictions torques.parquet motion.parquet

    Per joint: R2 (paper eq. 36), root-mean-square error (eq. 35), relative error 100 |tau -
    tau_hat| / |tau| in percent, number of samples. On the motion that the parameters were
    identified from this is direct validation; on another motion, cross validation. Rows are
    treated as by identify: give it the same options.
    """
