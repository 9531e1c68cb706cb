"""Facts about a table that CSV carries as columns, so that a pipe of CSV ends as one of Arrow.

CSV has no metadata. What the next command needs of a motion (what its positions have passed) stands
in columns that are the same in every row, which survive tools that leave rows out. What it needs of
a table of parameters (the delay, and what was fitted beside them) is JSON in its first row.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import pyarrow as pa

from scarid_cli.io import facts
from scarid_cli.io.table import METADATA_KEY, Metadata

BANDWIDTH, ORDER, NOISE = "passed_bandwidth", "passed_order", "velocity_noise"
BESIDE = "fitted_beside"
MOTIONS = ("measurement", "motion")  # kinds of tables
OF_PARAMETERS = ("additions", "bandwidth", "delay", "delay_error", "low_pass", "velocity_noise")


@dataclass(frozen=True)
class Carried:
    """The columns that CSV has beside those of the table: names and values.

    A number stands in every row, a text in the first one alone.
    """

    columns: Mapping[str, float | int | str]

    @classmethod
    def of(cls, schema: pa.Schema) -> Carried:
        """Those of a table with this schema and its metadata."""
        document = (schema.metadata or {}).get(METADATA_KEY)
        meta = Metadata.from_json(document) if document else Metadata()
        if meta.kind == "parameters":
            told = {k: meta.extra[k] for k in OF_PARAMETERS if meta.extra.get(k)}
            return cls({BESIDE: json.dumps(told, separators=(",", ":"))} if told else {})
        if meta.kind not in MOTIONS or not meta.extra.get("bandwidth"):
            return cls({})
        columns = {BANDWIDTH: meta.extra["bandwidth"], ORDER: meta.extra.get(facts.ORDER)}
        noise = enumerate(meta.extra.get("velocity_noise") or [], start=1)
        columns |= {f"{NOISE}{i}": float(value) for i, value in noise}
        own = {name: value for name, value in columns.items() if value is not None}
        return cls({name: value for name, value in own.items() if name not in schema.names})

    def schema(self, schema: pa.Schema) -> pa.Schema:
        """The schema with these columns."""
        kinds = {name: pa.scalar(value).type for name, value in self.columns.items()}
        return pa.schema([*schema, *(pa.field(name, kind) for name, kind in kinds.items())])

    def beside(self, batch: pa.RecordBatch, *, first: bool) -> pa.RecordBatch:
        """The rows with these columns; `first` if they are the first ones."""
        if not self.columns:
            return batch
        new = [_column(value, batch.num_rows, first=first) for value in self.columns.values()]
        return pa.RecordBatch.from_arrays(
            [*batch.columns, *new], names=[*batch.schema.names, *self.columns]
        )


@lru_cache(maxsize=16, typed=True)
def _column(value: float | str, rows: int, *, first: bool) -> pa.Array:
    if isinstance(value, str):
        return pa.array([value if first and k == 0 else "" for k in range(rows)], pa.string())
    return pa.repeat(pa.scalar(value), rows)


def facts_of(row: Mapping[str, str]) -> tuple[dict[str, Any], list[str]]:
    """The facts that columns of a first row carry, and these columns.

    What is no fact, as in a table of another program, stays a column.
    """
    if BESIDE in row:
        found = _decoded(row[BESIDE])
        known = isinstance(found, dict) and set(found) <= {*OF_PARAMETERS} and facts.sound(found)
        return (found, [BESIDE]) if known else ({}, [])
    noise: list[str] = []
    while (name := f"{NOISE}{len(noise) + 1}") in row:
        noise.append(name)
    values = [_decoded(row[name]) for name in noise]
    if BANDWIDTH not in row:
        return {}, []
    told = {"bandwidth": _decoded(row[BANDWIDTH]), "velocity_noise": values}
    if ORDER in row:
        told[facts.ORDER] = _decoded(row[ORDER])
    names = [BANDWIDTH, *noise, *([ORDER] if ORDER in row else [])]
    return (told, names) if facts.sound(told) else ({}, [])


def _decoded(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text
