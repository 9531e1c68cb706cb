"""Tables of people as tables of scarid: paths, results, frames, Arrow, dictionaries of columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import compute as pc
from pyarrow import parquet

from scarid.results import Log
from scarid_cli.errors import UsageFault
from scarid_cli.io.arrowio import of_arrow
from scarid_cli.io.table import Table

EXPECTED = "a path, a result of scarid, a frame of pandas or polars, an Arrow table, or columns"


def is_path(value: Any) -> bool:
    """Whether this names a file."""
    return isinstance(value, str | Path)


def path_of(value: str | Path) -> str:
    """The path as a shell would give it: `~` is the home of the user."""
    return str(Path(value).expanduser()) if str(value).startswith("~") else str(value)


def arrow_of(value: Any) -> pa.Table:
    """An Arrow table of what was given, with the metadata of scarid where it has them."""
    if isinstance(value, Log):
        return value.to_arrow()
    try:
        return _in_seconds(_arrow_of(value))
    except (pa.ArrowException, ValueError, TypeError, NotImplementedError) as why:
        reason = str(why).splitlines()[0]
        raise UsageFault(f"{type(value).__name__}: cannot become a table: {reason}") from None


def _arrow_of(value: Any) -> pa.Table:
    if isinstance(value, pa.RecordBatch):
        return pa.Table.from_batches([value])
    if isinstance(value, pa.Table):
        return value
    if _is_frame(value):
        frame = _with_index(value)
        return pa.Table.from_pandas(frame, preserve_index=False).replace_schema_metadata(None)
    if hasattr(value, "__arrow_c_stream__"):
        return pa.table(value)
    if isinstance(value, Mapping):
        return pa.table(dict(_columns(value)))
    raise UsageFault(f"{type(value).__name__} is no table; give {EXPECTED}")


def _columns(given: Mapping[Any, Any]) -> Iterator[tuple[str, pa.Array]]:
    """The columns of a dictionary; those of two dimensions are numbered from 1, as q1, q2.

    A masked value is missing. A single number, as the period in an archive, is no column.
    """
    arrays = {str(name): np.ma.asarray(x) for name, x in given.items() if np.ndim(x) > 0}
    rows = max((max(x.shape) for x in arrays.values()), default=0)
    for name, x in arrays.items():
        if x.ndim > 2:
            raise UsageFault(f"{name} has {x.ndim} dimensions; give rows, or rows by joints")
        if x.ndim == 1:
            yield name, _values(x)
            continue
        each = x.T if x.shape[0] == rows else x
        yield from ((f"{name}{i}", _values(one)) for i, one in enumerate(each, start=1))


def _values(x: Any) -> pa.Array:
    mask = np.ma.getmaskarray(x) if np.ma.is_masked(x) else None
    return pa.array(np.ma.getdata(x), mask=mask)


def _with_index(frame: Any) -> Any:
    """The frame of pandas; an index of times, or one that has a name, is its first column."""
    index = frame.index
    times = type(index).__name__ in ("DatetimeIndex", "TimedeltaIndex")
    name = index.name or ("time" if times else None)
    if not name or name in frame.columns:
        return frame
    return frame.rename_axis(name).reset_index()


def _in_seconds(table: pa.Table) -> pa.Table:
    """The table with durations as seconds."""
    for k, field in enumerate(table.schema):
        if pa.types.is_duration(field.type):
            whole = pc.cast(table.column(k).cast(pa.duration("ns")), pa.int64())
            table = table.set_column(k, field.name, pc.multiply(whole.cast(pa.float64()), 1e-9))
    return table


def table_of(value: Any) -> Table:
    """The table of what was given."""
    table = arrow_of(value).combine_chunks()
    return of_arrow(f"<{type(value).__name__}>", table.schema, iter(table.to_batches()))


def write(value: Any, path: Path) -> None:
    """Write a table in memory to a Parquet file, with every digit."""
    parquet.write_table(arrow_of(value), path)


def _is_frame(value: Any) -> bool:
    """Whether this is a frame of pandas."""
    return type(value).__module__.startswith("pandas") and hasattr(value, "columns")
