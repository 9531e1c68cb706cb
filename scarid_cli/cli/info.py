"""scarid info"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="info")
@options.table_input
@options.common
def command(file: str, **rest: Any) -> None:
    """Show what a table is: kind, columns with units, rows, sampling, history.

    \b
      scarid info log.parquet
      scarid trajgen --format arrow | scarid info

    Reads the whole table, in bounded memory. The kind of a CSV is told by its columns.
    """
    from scarid_cli.cli.job import job
    from scarid_cli.stages.info import described

    with job(rest) as run:
        for line in described(run.read(file, None)):
            click.echo(line)
