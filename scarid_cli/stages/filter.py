"""Low-pass filter columns of a table, either row by row or over the whole record."""

from __future__ import annotations

from dataclasses import replace

from scarid_cli.algorithms.processes.process import Process
from scarid_cli.errors import TooShort
from scarid_cli.io.facts import ORDER
from scarid_cli.io.table import Table
from scarid_cli.stages.records.columns import Plan, Task, processed


def filtered(
    table: Table, filters: dict[str, Process], left_out: list[TooShort] | None = None
) -> Table:
    """The table with some columns filtered; `filters` has the process of each.

    Each segment between gaps is filtered by itself. `left_out` receives the reason for each segment
    that was left out.
    """
    plan = Plan([Task(name, lowpass, (name,)) for name, lowpass in filters.items()])
    plan.check(table.period)
    table = replace(table, meta=table.meta.without(ORDER))  # another low-pass follows
    return processed(table, table.schema, lambda segment: (segment, plan), left_out)
