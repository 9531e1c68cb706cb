"""Logs with a row for each joint in turn, as of a bus whose motors answer one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import bad_data
from scarid_cli.io.table import Table, concatenated, doubles, number
from scarid_cli.stages.conversion.recorders import element
from scarid_cli.stages.conversion.wording import CLOCK, POSITION, QUANTITIES, words_of

JOINT = {"actuator", "axis", "id", "joint", "jointname", "motor", "name", "servo"}
MOST = 64  # joints that take turns


def one_row_for_all(table: Table, tell: Callable[[str], None]) -> tuple[Table, tuple[str, ...]]:
    """The table with one row for the joints that take turns, and their names in its arrays.

    Each column of numbers becomes an array, name[0], name[1], ..., in the order of the first turn,
    or of the joints' numbers; clocks are those of the first joint of a turn. A table that is none
    of these is left as it is. `tell` hears what was done, and of turns that lack a joint.
    """
    keys = [name for name in table.columns if {*words_of(name)} & JOINT]
    single = any(
        {*words_of(name)} & QUANTITIES[POSITION] and not any(map(str.isdigit, words_of(name)))
        for name in table.columns
    )
    if not keys or not single or "q1" in table.columns:
        return table, ()
    batches = iter(table.batches)
    held: list[pa.RecordBatch] = []
    while sum(batch.num_rows for batch in held) < 2 * MOST and (more := next(batches, None)):
        held.append(more)
    first = concatenated(held) if any(batch.num_rows for batch in held) else None
    found = (_Turns.of(first, key, tell) for key in keys if first)
    turns = next((x for x in found if x), None)
    table = replace(table, batches=chain(held, batches))
    if turns is None:
        return table, ()
    tell(
        f"one row for each of {len(turns.joints)} joints in turn, by {turns.key}: put into one row "
        f"for all{turns.late}"
    )
    schema = turns.schema(table.schema)
    names = () if turns.numbered else turns.joints
    return replace(table, schema=schema, batches=turns.batches(table, schema)), names


def refuse_long(table: Table) -> None:
    """Refuse rows with one value each, as InfluxDB exports them, of which a query makes whole ones.

    Raises:
        BadData: the columns are a time, the name of a field, and its value.
    """
    if {"_time", "_field", "_value"} <= {*table.columns}:
        raise bad_data(
            table.name,
            "a row for each value of each field, as of InfluxDB",
            expected="one row for all",
            remedy='end the query with |> pivot(rowKey: ["_time"], columnKey: ["_field"], '
            'valueColumn: "_value"), with the tag of the joint in columnKey if there is one',
        )


def _texts(column: pa.Array) -> list[str]:
    values = column.to_pylist()
    return [f"{x:g}" if isinstance(x, float) else str(x) for x in values]


def _numbers(rows: pa.RecordBatch, name: str) -> Array:
    found = rows.column(name).cast(pa.float64()).to_numpy(zero_copy_only=False)
    return np.asarray(found, dtype=np.float64)


@dataclass
class _Turns:
    """The joints in the order of their turns, whose name or number is in the column `key`.

    A turn takes less than the `longest` time of the `clock`, if there is one.
    """

    key: str
    joints: tuple[str, ...]
    clocks: tuple[str, ...]
    tell: Callable[[str], None]
    clock: str = ""
    longest: float = np.inf
    late: str = ""

    @classmethod
    def of(cls, batch: pa.RecordBatch, key: str, tell: Callable[[str], None]) -> _Turns | None:
        """The turns with which rows begin; None if the values of the key do not take turns."""
        values = _texts(batch.column(key).slice(0, 2 * MOST))
        count = values.index(values[0], 1) if values[0] in values[1:] else 0
        first = values[:count]
        if not 1 < count <= MOST or len({*first}) < count or values[count : 2 * count] != first:
            return None
        clocks = tuple(name for name in batch.schema.names if {*words_of(name)} & CLOCK)
        found = cls(key, tuple(first), clocks, tell)
        times = [name for name in clocks if not pa.types.is_string(batch.schema.field(name).type)]
        if times:
            t = _numbers(batch, times[0])
            span, turn = float(t[count - 1] - t[0]), float(t[count] - t[0])
            # Parts of two turns, each of which lacks the other joints, take more than a turn.
            if turn > span:
                found.clock, found.longest = times[0], 0.5 * (span + turn)
            if span > 0.0:
                found.late = f", with the time of the first; the last comes {span:.3g} later"
        return found

    @property
    def numbered(self) -> bool:
        """Whether the joints have numbers, which then tell their order."""
        return all(joint.isdecimal() for joint in self.joints)

    @property
    def _order(self) -> list[int]:
        """The places in a turn of the elements of an array."""
        places = range(len(self.joints))
        return sorted(places, key=lambda k: int(self.joints[k])) if self.numbered else [*places]

    def _arrays(self, schema: pa.Schema) -> list[str]:
        apart = {self.key, *self.clocks}
        return [f.name for f in schema if f.name not in apart and not pa.types.is_string(f.type)]

    def schema(self, schema: pa.Schema) -> pa.Schema:
        arrays = self._arrays(schema)
        fields: list[pa.Field] = []
        for field in schema:
            if field.name in arrays:
                unit = field.metadata and field.metadata.get(b"unit", b"").decode()
                count = len(self.joints)
                fields += [number(element(field.name, k), unit or "") for k in range(count)]
            elif field.name != self.key:
                fields.append(field)
        return pa.schema(fields)

    def batches(self, table: Table, schema: pa.Schema) -> Iterator[pa.RecordBatch]:
        arrays, count = self._arrays(table.schema), len(self.joints)
        place = {joint: k for k, joint in enumerate(self.joints)}
        held: list[pa.RecordBatch] = []
        row = incomplete = 0
        for batch in chain(table.batches, [None]):
            if batch is not None:
                held.append(batch)
            rows = concatenated(held) if held else None
            if rows is None:
                break
            at = self._places(rows, place, table, row)
            starts = np.flatnonzero(np.diff(at, prepend=count) <= 0)
            ends = np.append(starts[1:], len(at))
            if batch is not None:  # the last turn may go on
                ends, starts = ends[:-1], starts[:-1]
            whole = ends - starts == count
            if self.clock and len(starts):
                t = _numbers(rows, self.clock)
                whole &= t[ends - 1] - t[starts] < self.longest
            incomplete += int(np.count_nonzero(~whole))
            done = int(ends[-1]) if len(ends) else 0
            row, held = row + done, [rows.slice(done)] if done < rows.num_rows else []
            if whole.any():
                yield self._joined(rows, starts[whole], arrays, schema)
            if batch is None:
                break
        if incomplete:
            self.tell(f"turns left out, as they lack a joint: {incomplete}")

    def _joined(
        self, rows: pa.RecordBatch, starts: Numbers, arrays: list[str], schema: pa.Schema
    ) -> pa.RecordBatch:
        columns: list[pa.Array] = []
        for field in rows.schema:
            if field.name in arrays:
                values = _numbers(rows, field.name)
                columns += [doubles(values[starts + k]) for k in self._order]
            elif field.name != self.key:
                columns.append(rows.column(field.name).take(pa.array(starts)))
        return pa.RecordBatch.from_arrays(columns, schema=schema)

    def _places(
        self, rows: pa.RecordBatch, place: dict[str, int], table: Table, row: int
    ) -> Numbers:
        """The place of the joint of each row in a turn."""
        texts = _texts(rows.column(self.key))
        found = [place.get(text, -1) for text in texts]
        if -1 in found:
            at = found.index(-1)
            raise bad_data(
                table.name,
                repr(texts[at]),
                expected=f"one of {', '.join(self.joints)}, as in the first rows",
                remedy="keep only the rows of the robot's joints",
                row=table.row(row + at + 1),
                column=self.key,
            )
        return np.array(found, dtype=np.int64)
