"""Which columns of a table of samples are drawn, and which of them share a panel."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import pyarrow as pa

from scarid_cli.errors import bad_data
from scarid_cli.io.table import SEGMENT, Table
from scarid_cli.printable import printable

SIGNAL = re.compile(r"(d{0,2}q|tau)([1-9]\d*)(?:_(ref|true|meas|cmd|pred|residual|band))?\Z")
ORDER = ("q", "dq", "ddq", "tau")
# What a kind of table is for; the other columns are drawn by --columns.
SHOWN = {"measurement": ("q", "tau"), "motion": ("dq", "ddq"), "prediction": ("tau",)}
MARKS = ("t", SEGMENT, "settled")


@dataclass(frozen=True)
class Group:
    """The columns of one panel, and the signal and the joint that they are of, if any."""

    columns: tuple[str, ...]
    signal: str
    joint: int | None


def groups(table: Table, kind: str | None, wanted: Sequence[str]) -> list[Group]:
    """The panels: a signal with its reference, its truth or its prediction.

    They are in the order in which columns are `wanted`; without a wish, joint by joint.
    """
    numeric = [f.name for f in table.schema if _is_number(f.type) and f.name not in MARKS]
    if wanted:
        return _together(_chosen(table, numeric, wanted))
    shown = [column for column in numeric if _is_shown(column, kind)] or numeric
    return _together(sorted(shown, key=_place))


def _is_number(kind: pa.DataType) -> bool:
    return bool(pa.types.is_floating(kind) or pa.types.is_integer(kind))


def _is_shown(column: str, kind: str | None) -> bool:
    found = SIGNAL.match(column)
    return kind not in SHOWN or (found is not None and found[1] in SHOWN[kind])


def _place(column: str) -> tuple[int, int]:
    """Signals joint by joint; what is no signal comes last, in its own order."""
    found = SIGNAL.match(column)
    return (int(found[2]), ORDER.index(found[1])) if found else (sys.maxsize, 0)


def _chosen(table: Table, numeric: list[str], wanted: Sequence[str]) -> list[str]:
    """The columns of these names or patterns, each once, in the order in which they are wanted."""
    found: list[str] = []
    for name in wanted:
        matching = [column for column in numeric if fnmatchcase(column, name)]
        if not matching:
            raise bad_data(
                table.name,
                f"the columns {', '.join(map(printable, table.columns))}",
                expected="a column of numbers of this name",
                remedy="give --columns names, or patterns such as 'tau*'",
                column=name,
            )
        found += [column for column in matching if column not in found]
    return found


def _together(columns: Sequence[str]) -> list[Group]:
    """The columns in panels, in the order of the first column of each."""
    panels: dict[tuple[str, str], list[str]] = {}
    for column in columns:
        found = SIGNAL.match(column)
        panels.setdefault((found[1], found[2]) if found else ("", column), []).append(column)
    return [
        Group(tuple(sorted(names, key=len)), signal, int(joint) if signal else None)
        for (signal, joint), names in panels.items()
    ]
