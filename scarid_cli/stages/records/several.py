"""Several logs as the segments of one table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import pyarrow as pa

from scarid_cli.algorithms.processes.rates import rate_text
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.clock import DRIFT
from scarid_cli.io.facts import ORDER
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import SEGMENT, Table, doubles, integers, matrix, segments_of, with_columns

PAUSE = 1.0  # s, between a log and the next one whose time does not go on
LOGS = "logs"  # key of the metadata: how many logs were joined
MATCHED = "settled"  # the column that a matched motion has


def joined(tables: Sequence[Table]) -> Table:
    """The rows of all logs, of which each begins a new segment; they are read one after the other.

    Sampling period, units and the kind of columns must agree. The columns are those that all logs
    have. Where the time of a log does not come after that of the one before, it is moved on.
    """
    first = tables[0]
    for table in tables[1:]:
        _require_alike(first, table)
    fields = [f for f in first.schema if f.name != SEGMENT and _in_all(f, tables)]
    schema = pa.schema([*fields, pa.field(SEGMENT, pa.int64())])
    meta = replace(first.meta, extra=_extra(tables), history=_history(tables))
    others = f"{len(tables) - 1} other{'s' if len(tables) > 2 else ''}"
    name = f"{first.name} and {others}"
    return replace(first, name=name, schema=schema, meta=meta, batches=_rows(tables, schema))


def _in_all(field: pa.Field, tables: Sequence[Table]) -> bool:
    """Whether all logs have a column of this name and type."""
    return all(
        field.name in t.columns and t.schema.field(field.name).type == field.type for t in tables
    )


def _require_alike(first: Table, table: Table) -> None:
    """Refuse a log that cannot be taken together with the first one."""
    if abs(table.period - first.period) > DRIFT * first.period:
        rate = rate_text(1.0 / max(first.period, table.period))
        raise bad_data(
            table.name,
            f"a period of {table.period:g} s",
            expected=f"{first.period:g} s, as in {first.name}",
            remedy=f"put all logs on one rate with `scarid resample --rate {rate}`",
        )
    for what, own, other in (
        ("derivatives dq, ddq", *(bool(numbered(t.columns, "ddq")) for t in (table, first))),
        (f"a column {MATCHED}", *(MATCHED in t.columns for t in (table, first))),
    ):
        if own != other:
            having, lacking = (table, first) if own else (first, table)
            raise BadData(
                f"{having.name} has {what}, but {lacking.name} has not; give logs that were all "
                "treated in the same way by `scarid differentiate`, or all as they were measured"
            )
    for column in table.columns:
        units = [t.unit(column) if column in t.columns else None for t in (table, first)]
        if all(units) and units[0] != units[1]:
            raise bad_data(
                table.name,
                f"unit {units[0]}",
                expected=f"{units[1]}, as in {first.name}",
                remedy="convert the column first",
                column=column,
            )


def _extra(tables: Sequence[Table]) -> dict[str, Any]:
    """The metadata of the first log, with the least bandwidth and the greatest noise of all.

    Logs behind different low-passes have passed none that could be stated.
    """
    extra = dict(tables[0].meta.extra)
    passed = {(t.meta.extra.get("bandwidth"), t.meta.extra.get(ORDER)) for t in tables}
    if len(passed) > 1:
        extra.pop(ORDER, None)
    extra["bandwidth"] = min(table.meta.extra.get("bandwidth") or 0.0 for table in tables) or None
    noise = [table.meta.extra.get("velocity_noise") or [] for table in tables]
    alike = len({len(values) for values in noise}) == 1
    extra["velocity_noise"] = [max(values) for values in zip(*noise, strict=True)] if alike else []
    extra[LOGS] = len(tables)
    return extra


def _history(tables: Sequence[Table]) -> tuple[dict[str, Any], ...]:
    """The histories of all logs, one after the other; what they share is there once."""
    history: list[dict[str, Any]] = []
    for table in tables:
        history += [entry for entry in table.meta.history if entry not in history]
    return tuple(history)


def _rows(tables: Sequence[Table], schema: pa.Schema) -> Iterator[pa.RecordBatch]:
    time, number = float("-inf"), -1
    for table in tables:
        shift: float | None = None
        offset = 0
        for batch in table.batches:
            t, own = matrix(batch, ["t"])[0], segments_of(batch)
            if shift is None:
                shift = 0.0 if t[0] > time else time + PAUSE - float(t[0])
                offset = number + 1 - int(own[0])
            time, number = float(t[-1]) + shift, int(own[-1]) + offset
            new = {"t": doubles(t + shift)} if shift else {}
            yield with_columns(batch, schema, {**new, SEGMENT: integers(own + offset)})
