"""scarid convert"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="convert")
@options.table_input
@options.table_output
@options.common
def command(file: str, **rest: Any) -> None:
    """Change the format of a table: CSV, Parquet, Arrow stream or Arrow file.

    \b
      scarid convert log.csv -o log.parquet
      scarid convert log.parquet | head
      scarid convert --format arrow log.csv | scarid info

    Numbers are kept exactly, in both directions. CSV carries no metadata: units and history end
    there.
    """
    from scarid_cli.cli.job import job

    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        run.write(run.recorded(run.read(file, None)), out)
