"""Names of joints that stand in the cells of a log, beside arrays in their order.

Messages of joint states have them: drivers list joints by the alphabet, and not from the base.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import chain

import pyarrow as pa

from scarid_cli.errors import bad_data
from scarid_cli.io.table import Table

NAMES = re.compile(r"(?i)(?:.*[._/])?(?:joint_?)?names?(?:[\[_.]?\d+\]?)?")
LIST = re.compile(r"[\[({]([^\[\](){}]+)[\])}]")
PLACE = re.compile(r"(\d+)\]?(?!.*\d)")  # the last number in the name of a column


def names_in_cells(table: Table) -> tuple[Table, tuple[str, ...]]:
    """The table, and the names of the joints in the order of its arrays; empty if it has none.

    They stand in a column for each, `name[0]`, `name[1]`, ..., or in one column of lists, and are
    the same in all rows: reading the table refuses a row with others.
    """
    columns = [
        f.name for f in table.schema if pa.types.is_string(f.type) and NAMES.fullmatch(f.name)
    ]
    if not columns or "q1" in table.columns:
        return table, ()
    batches = iter(table.batches)
    held = next((batch for batch in batches if batch.num_rows), None)
    if held is None:
        return replace(table, batches=iter(())), ()
    table = replace(table, batches=chain([held], batches))
    firsts = [str(held.column(column)[0]) for column in columns]
    names = tuple(firsts) if len(columns) > 1 else _listed(firsts[0])
    if len({*names}) < len(names) or len(names) < 2 or not all(names):
        return table, ()
    return replace(table, batches=_alike(table, dict(zip(columns, firsts, strict=True)))), names


def _listed(text: str) -> tuple[str, ...]:
    """The names in a text such as `['elbow', 'shoulder']`."""
    found = LIST.fullmatch(text.strip())
    return tuple(word.strip(" '\"") for word in found[1].split(",")) if found else ()


def _alike(table: Table, firsts: dict[str, str]) -> Iterator[pa.RecordBatch]:
    row = 0
    for batch in table.batches:
        for column, first in firsts.items():
            other = next((k for k, x in enumerate(batch.column(column)) if str(x) != first), None)
            if other is not None:
                raise bad_data(
                    table.name,
                    f"{str(batch.column(column)[other])!r}",
                    expected=f"{first!r} as in the first row",
                    remedy="keep the messages of one kind, with the same joints in one order",
                    row=table.row(row + other + 1),
                    column=column,
                )
        row += batch.num_rows
        yield batch


def in_their_order(
    columns: dict[str, str], names: Sequence[str], joints: Sequence[str]
) -> dict[str, str]:
    """The columns (new name: old name) of arrays, numbered by the order of the joints.

    The k-th element of an array is of the k-th of `names`. Elements of other joints are left out.
    As they are, if some joint is none of the names.
    """
    if not {*joints} <= {*names}:
        return columns
    arrays: dict[str, dict[int, str]] = {}
    for old in columns.values():
        if place := PLACE.search(old):
            arrays.setdefault(old[: place.start()], {})[int(place[1])] = old
    named = {
        old: names[k]
        for own in arrays.values()
        if len(own) == len(names)
        for k, (_, old) in enumerate(sorted(own.items()))
    }
    number = {joint: str(i) for i, joint in enumerate(joints, start=1)}
    found = {}
    for new, old in columns.items():
        if old not in named:
            found[new] = old
        elif named[old] in number:
            found[re.sub(r"\d+", number[named[old]], new, count=1)] = old
    return found
