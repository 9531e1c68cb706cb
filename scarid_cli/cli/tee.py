"""The declaration of `scarid tee`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare


@declare("tee")
@click.argument("place", metavar="FILE")
@options.table_format
@options.common
def command() -> None:
    """Write the table from standard input to FILE, and pass it on.

    \b
      scarid differentiate log.csv then tee motion.parquet then identify
      scarid filter log.csv then tee filtered.csv then differentiate then tee motion.arrow then info

    FILE gets the same bytes as with -o FILE of the command before, in the format of its extension.
    The history does not mention it. If a command before or after fails, no FILE is left.
    """
