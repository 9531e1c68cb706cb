"""The declaration of `scarid compare`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare


@declare("compare")
@click.argument("files", metavar="FIRST SECOND...", nargs=-1, required=True, type=options.INPUT)
@click.option(
    "--require",
    cls=options.Unrecorded,
    type=click.Choice(("same",)),
    help="Exit with status 3 if a table differs from the first one; the table of differences is "
    "written all the same.",
)
@options.as_json
@options.table_output
@options.common
def command() -> None:
    """Compare identifications: which parameters differ by more than their errors allow.

    \b
      scarid compare before.parquet after.parquet
      scarid compare january.parquet february.parquet march.parquet -o drift.csv

    The tables are those of `scarid identify`, for one robot. Every table is compared with the
    first one: for each parameter the difference, its standard error, the number of errors, and a
    p-value from Student's t. The p-values are corrected by Holm's method, so that at most one
    comparison in twenty reports a difference where there is none. If the tables carry covariances
    (Parquet and Arrow), all parameters are also tested together (Hotelling's F test), which finds
    differences that no single parameter shows. From three tables on, the trend is tested as well.

    The verdict goes to standard error and into the metadata. To find out what has changed, give a
    log to `scarid validate`.
    """
