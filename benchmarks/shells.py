"""Shell pipes of this installation's `scarid`, for benchmarks of whole experiments."""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from scarid_cli.arrays import Array

PAUSE = 1.0  # s between two logs of one record: `scarid resample` makes a segment of each


def shell(folder: Path, line: str) -> str:
    """What a shell line prints, with the commands of this installation first."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        ["bash", "-euo", "pipefail", "-c", line],
        cwd=folder,
        env={**os.environ, "PATH": path},
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    ).stdout


def column(table: str, name: str, parameters: Sequence[str]) -> Array:
    """A column of a printed table of these parameters; nan where it is empty."""
    rows = {row["parameter"]: row[name] for row in csv.DictReader(table.splitlines())}
    return np.array([float(rows[parameter] or "nan") for parameter in parameters])


def recorded(logs: Sequence[Path], path: Path) -> None:
    """Write several logs (.parquet) as one record, with gaps between them."""
    tables, start = [], 0.0
    for log in logs:
        table = pq.read_table(log)
        place = table.schema.get_field_index("t")
        t = table["t"].to_numpy() + start
        tables.append(table.set_column(place, table.schema.field("t"), pa.array(t)))
        start = t[-1] + PAUSE
    facts = tables[0].schema.metadata
    pq.write_table(
        pa.concat_tables([table.replace_schema_metadata(facts) for table in tables]), path
    )
