"""The declaration of `scarid tee`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare


@declare("tee")
@click.argument("place", metavar="OUTPUT")
@options.table_format
@options.common
def command() -> None:
    """Write the table from standard input to OUTPUT, and pass it on.

    \b
      scarid differentiate log.csv then tee motion.parquet then identify
      scarid filter log.csv then tee filtered.csv then differentiate then tee motion.arrow then info

    OUTPUT gets the same bytes as with -o OUTPUT of the command before, in the format of its
    extension.
    The history does not mention it. If a command before or after fails, no OUTPUT is left.
    """
