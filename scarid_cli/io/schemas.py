"""The kinds of tables, read from `schemas/*.json` (in the Frictionless Table Schema).

A field named `q{i}` stands for one column per joint, with i from 1. Its `unit` is a string, or an
object with one unit for each type of joint.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path

import pyarrow as pa

import scarid_cli.schemas

COUNTED_FROM_0 = "q0"  # a column of logs in which q1 is another joint than ours
TYPES = {"number": pa.float64(), "integer": pa.int64(), "string": pa.string()}


@dataclass(frozen=True)
class Field:
    """One field of a table schema; a `per_joint` field matches one column per joint."""

    name: str
    type: pa.DataType
    units: tuple[str, ...]
    required: bool
    description: str

    @property
    def per_joint(self) -> bool:
        return "{i}" in self.name

    def about(self, column: str) -> str:
        """The description of this column, with the number of its joint."""
        match = self.pattern.match(column)
        joint = match.group(1) if match and self.per_joint else "i"
        return self.description.replace("joint i", f"joint {joint}")

    @cached_property
    def pattern(self) -> re.Pattern[str]:
        return re.compile(re.escape(self.name).replace(r"\{i\}", r"([1-9]\d*)") + r"\Z")


@dataclass(frozen=True)
class TableSchema:
    """One kind of table. It is `sampled` if its rows are samples at a constant rate."""

    kind: str
    version: int
    title: str
    description: str
    sampled: bool
    fields: tuple[Field, ...]

    def field_of(self, column: str) -> Field | None:
        """The field that a column of this name belongs to."""
        return next((field for field in self.fields if field.pattern.match(column)), None)

    def arrow(self) -> pa.Schema:
        """The columns of a kind of table that has no columns per joint."""
        return pa.schema(
            [
                pa.field(f.name, f.type, metadata={"unit": f.units[0]} if f.units else None)
                for f in self.fields
                if not f.per_joint
            ]
        )

    def missing_from(self, columns: list[str]) -> str | None:
        """The first required column that is missing (joint 1 stands for all joints)."""
        names = (f.name.replace("{i}", "1") for f in self.fields if f.required)
        return next((name for name in names if name not in columns), None)


@cache
def load(kind: str) -> TableSchema:
    """Read the schema of one kind of table."""
    text = Path(next(iter(scarid_cli.schemas.__path__)), f"{kind}.json").read_text("utf-8")
    document = json.loads(text)
    fields = tuple(
        Field(
            name=field["name"],
            type=TYPES[field["type"]],
            units=_units(field.get("unit")),
            required=field.get("constraints", {}).get("required", False),
            description=field["description"],
        )
        for field in document["fields"]
    )
    own = {key: document[key] for key in ("version", "title", "description", "sampled")}
    return TableSchema(kind=document["name"], fields=fields, **own)


def _units(unit: str | dict[str, str] | None) -> tuple[str, ...]:
    if unit is None:
        return ()
    return (unit,) if isinstance(unit, str) else tuple(unit.values())


# From the most to the least demanding: a table is of the first kind whose required columns it has.
KINDS = (
    "parameters",
    "expected",
    "metrics",
    "comparison",
    "payload",
    "loads",
    "carried",
    "gains",
    "trials",
    "published",
    "prediction",
    "residual",
    "motion",
    "measurement",
    "trajectory",
    "trace",
)


def detect(columns: list[str]) -> TableSchema | None:
    """The kind of table that has these columns, for tables without metadata."""
    schemas = (load(kind) for kind in KINDS)
    return next((schema for schema in schemas if schema.missing_from(columns) is None), None)


@cache
def column_type(column: str) -> pa.DataType | None:
    """The type of a column that some schema knows, whatever the kind of table."""
    fields = (load(kind).field_of(column) for kind in KINDS)
    return next((field.type for field in fields if field is not None), None)


def named(columns: Sequence[str]) -> bool:
    """Whether a log has our names, without which `scarid convert` may know its own."""
    return {"t", "q1"} <= {*columns} and COUNTED_FROM_0 not in columns


def numbered(columns: list[str], *prefixes: str) -> list[str]:
    """The columns that are one of these prefixes and the number of a joint: q1, q2, ..."""
    return [c for c in columns for p in prefixes if c.startswith(p) and c[len(p) :].isdigit()]


def of_joints(joints: int, *names: str) -> list[str]:
    """The columns of all joints with these names, in which {i} is the number of the joint."""
    return [name.replace("{i}", str(i)) for name in names for i in range(1, joints + 1)]


def joints_of(columns: list[str], prefix: str) -> int:
    """The number of joints with a column `prefix1`, `prefix2`, ..., up to the first missing one."""
    count = 0
    while f"{prefix}{count + 1}" in columns:
        count += 1
    return count
