"""Velocities that the log itself has: `dq1` or `dq1_measured`, and so on."""

from __future__ import annotations

from dataclasses import replace

import pyarrow as pa

from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table, without

MEASURED = "_measured"


def measured(names: list[str]) -> list[str]:
    """The columns of measured velocities; where a joint has two of them, that with the suffix."""
    own = [name for name in names if name.endswith(MEASURED) and _is_velocity(name)]
    return own + [name for name in numbered(names, "dq") if f"{name}{MEASURED}" not in own]


def _is_velocity(name: str) -> bool:
    """Whether this is the velocity of a joint, with the suffix or without it."""
    return bool(numbered([name.removesuffix(MEASURED)], "dq"))


def used(table: Table) -> Table:
    """The table with the measured velocities as dq."""
    found = measured(table.columns)
    for name in numbered(table.columns, "dq"):
        table = table if name in found else without(table, name)
    return _renamed(table, {name: name.removesuffix(MEASURED) for name in found})


def apart(table: Table) -> Table:
    """The table with dq and ddq of its own as `dq*_measured`, unless they are estimates.

    In a motion they are estimates: those of an earlier differentiation, which are replaced.
    """
    if table.meta.kind == "motion" or "settled" in table.columns:
        return table
    own = numbered(table.columns, "dq", "ddq")
    new = {name: f"{name}{MEASURED}" for name in own if f"{name}{MEASURED}" not in table.columns}
    return _renamed(table, new)


def _renamed(table: Table, new: dict[str, str]) -> Table:
    schema = pa.schema([field.with_name(new.get(field.name, field.name)) for field in table.schema])
    if schema.names == table.columns:
        return table
    batches = (batch.rename_columns(schema.names) for batch in table.batches)
    return replace(table, schema=schema, batches=batches)
