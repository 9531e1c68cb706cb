"""Tables of people as tables of scarid: paths, results, frames, Arrow, dictionaries of columns."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from scarid.results import Log
from scarid_cli.errors import UsageFault
from scarid_cli.io.arrowio import of_arrow
from scarid_cli.io.table import Table

EXPECTED = "a path, a result of scarid, a frame of pandas or polars, an Arrow table, or columns"


def is_path(value: Any) -> bool:
    """Whether this names a file."""
    return isinstance(value, str | Path)


def is_columns(value: Any) -> bool:
    """Whether this is a dictionary of columns, and not of settings."""
    return isinstance(value, Mapping) and any(np.ndim(x) > 0 for x in value.values())


def is_table(value: Any) -> bool:
    """Whether this is a table in memory."""
    arrow = isinstance(value, pa.Table | pa.RecordBatch) or hasattr(value, "__arrow_c_stream__")
    return arrow or isinstance(value, Log) or _is_frame(value) or is_columns(value)


def arrow_of(value: Any) -> pa.Table:
    """An Arrow table of what was given, with the metadata of scarid where it has them."""
    if isinstance(value, Log):
        return value.to_arrow()
    if isinstance(value, pa.RecordBatch):
        return pa.Table.from_batches([value])
    if isinstance(value, pa.Table):
        return value
    if _is_frame(value):
        return pa.Table.from_pandas(value, preserve_index=False).replace_schema_metadata(None)
    if hasattr(value, "__arrow_c_stream__"):
        return pa.table(value)
    if isinstance(value, Mapping):
        return pa.table({name: np.asarray(x) for name, x in value.items()})
    raise UsageFault(f"{type(value).__name__} is no table; give {EXPECTED}")


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
