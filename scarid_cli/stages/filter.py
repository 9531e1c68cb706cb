"""Low-pass chosen columns: row by row as they come, or forwards and backwards over all of them."""

from __future__ import annotations

from scarid_cli.algorithms.process import Process
from scarid_cli.io.table import Table
from scarid_cli.stages.columns import Task, processed


def filtered(table: Table, filters: dict[str, Process]) -> Table:
    """The table with some columns filtered, each by its own process."""
    tasks = [Task(name, lowpass, (name,)) for name, lowpass in filters.items()]
    return processed(table, tasks, table.schema)
