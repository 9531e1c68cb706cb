"""Low-pass chosen columns: row by row as they come, or forwards and backwards over all of them."""

from __future__ import annotations

from scarid_cli.algorithms.processes.process import Process
from scarid_cli.errors import TooShort
from scarid_cli.io.table import Table
from scarid_cli.stages.columns import Plan, Task, processed


def filtered(
    table: Table, filters: dict[str, Process], left_out: list[TooShort] | None = None
) -> Table:
    """The table with some columns filtered, each by its own process, between gaps.

    `left_out` receives why a segment was.
    """
    plan = Plan([Task(name, lowpass, (name,)) for name, lowpass in filters.items()])
    plan.check(table.period)
    return processed(table, table.schema, lambda segment: (segment, plan), left_out)
