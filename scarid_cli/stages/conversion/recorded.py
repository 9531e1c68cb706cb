"""A table from the topics of a recording: one clock, and torques of another topic joined to it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array, Numbers
from scarid_cli.errors import bad_data
from scarid_cli.io.signals import TAU, Series
from scarid_cli.io.table import Metadata, Table, doubles, number
from scarid_cli.runs import RUN, period_of, run_starts

LINEAR, HOLD = "linear", "hold"
READ_ROWS = 1 << 13
LATE = 5.0  # periods of the torques' topic after which a row that waits for a value is reported


@dataclass(frozen=True)
class Rows:
    """Rows in the order of their times [ns], by column an array (rows, joints)."""

    times: Numbers
    columns: dict[str, Array]
    notes: list[str] = field(default_factory=list)

    def at(self, rows: Any) -> Rows:
        """Some of the rows."""
        columns = {name: x[rows] for name, x in self.columns.items()}
        return Rows(self.times[rows], columns, self.notes)

    @property
    def rate(self) -> float:
        """Rows per second; 0 for a single one."""
        span = 1e-9 * float(self.times[-1] - self.times[0])
        return (len(self.times) - 1) / span if span > 0.0 else 0.0


def recorded(name: str, main: Series, other: Series | None, join: str) -> tuple[Table, list[str]]:
    """The table of a topic, with the torques of another one if it is given, and what to report.

    Torques are joined to the times of the positions by linear interpolation, or by holding the
    last value (`join`); rows that have none on one side are left out.
    """
    notes: list[str] = []
    main, other = _stamped(main, notes), other and _stamped(other, notes)
    stamps = main.has_stamps and (other is None or other.has_stamps)
    columns = {k: x for k, x in main.columns.items() if other is None or k != TAU}
    rows = _rows(main.stamped if stamps else main.received, columns, main)
    extra: dict[str, Any] = {"topic": main.topic, "joints": list(main.joints)}
    extra["clock"] = "time stamps" if stamps else "receive times, because there are no time stamps"
    if not stamps:
        without = main if not main.has_stamps or other is None else other
        notes.append(f"the clock is that of the recorder: {_lacking(without)}")
    if other is None:
        notes += _without_torques(main)
    if other is not None:
        torques = {TAU: other.columns[TAU]} if TAU in other.columns else {}
        second = _rows(other.stamped if stamps else other.received, torques, other)
        rows, facts, report = _joined(name, rows, second, join)
        extra |= {"torque_topic": other.topic, **facts}
        notes = [*notes, *second.notes, report]
    return _table(name, rows, extra), [*rows.notes, *notes]


def _stamped(source: Series, notes: list[str]) -> Series:
    """The messages that have stamps, if these are most: simulators publish before their clock."""
    lacking = source.stamped <= 0
    count = int(np.count_nonzero(lacking))
    if not count or 2 * count >= len(lacking):
        return source
    notes.append(
        f"{count} message{'s' if count > 1 else ''} of {source.topic} left out: their stamps are 0 "
        "(the clock had not begun)"
    )
    columns = {name: x[~lacking] for name, x in source.columns.items()}
    return replace(
        source,
        stamped=source.stamped[~lacking],
        received=source.received[~lacking],
        columns=columns,
    )


def _lacking(source: Series) -> str:
    found = int(np.count_nonzero(source.stamped > 0))
    return (
        f"only {found} of {len(source.stamped)} messages of {source.topic} have stamps"
        if found
        else f"{source.topic} has no stamps"
    )


def _without_torques(source: Series) -> list[str]:
    """What is said of messages without efforts, or with nan for all of them."""
    efforts = source.columns.get(TAU)
    if efforts is not None and not np.isnan(efforts).all():
        return []
    what = "have no efforts" if efforts is None else "have nan for every effort"
    return [
        f"warning: the messages of {source.topic} {what}: the log has positions only, and no "
        "parameters can be identified from it (--torque-topic NAME joins torques of another topic)"
    ]


def _rows(times: Numbers, columns: dict[str, Array], source: Series) -> Rows:
    """The rows that have every column, in the order of time; each remedy is noted."""
    notes: list[str] = []
    if source.skipped:
        notes.append(
            f"{source.skipped} messages of {source.topic} left out: they do not have all of the "
            f"joints {', '.join(source.joints)}"
        )
    complete = np.ones(len(times), dtype=np.bool_)
    for name, values in columns.items():
        lacks = np.isnan(values).any(axis=1)
        if lacks.any() and not lacks.all():
            notes.append(
                f"{int(lacks.sum())} messages of {source.topic} left out: they have no "
                f"{name.replace('{i}', '')} (--torque-topic {source.topic} joins torques that come "
                "in messages of their own)"
            )
            complete &= ~lacks
    columns = {name: x[complete] for name, x in columns.items() if not np.isnan(x).all()}
    rows = Rows(times[complete], columns, notes)
    rows, runs = _one_after_the_other(rows)
    if runs:
        notes.append(
            f"warning: the times of {source.topic} go back {runs} time{'s' if runs > 1 else ''}: "
            f"{runs + 1} runs, put one after the other with gaps, where `scarid resample` splits"
        )
    late = int(np.count_nonzero(np.diff(rows.times) < 0))
    if late:
        notes.append(f"{late} messages of {source.topic} put back into the order of their times")
        rows = rows.at(np.argsort(rows.times, kind="stable"))
    return rows


def _one_after_the_other(rows: Rows) -> tuple[Rows, int]:
    """Runs whose clock began anew, one after the other; and how often the time went back."""
    period = int(period_of(rows.times))
    starts = run_starts(rows.times, period)
    if not starts:
        return rows, 0
    times = rows.times.copy()
    for start in starts:
        times[start:] += times[start - 1] + RUN * period - times[start]
    return replace(rows, times=times), len(starts)


def _joined(name: str, rows: Rows, second: Rows, join: str) -> tuple[Rows, dict[str, Any], str]:
    """The rows with the torques of the second topic, what the metadata states, and a report."""
    if not second.columns or not len(second.times):
        raise bad_data(name, "no efforts", expected="some", remedy="choose another --torque-topic")
    inside = rows.times >= second.times[0]
    if join == LINEAR:
        inside &= rows.times <= second.times[-1]
    if not inside.any():
        raise bad_data(
            name,
            "torques and positions that were recorded at different times",
            expected="two topics of one record",
            remedy="choose another --torque-topic",
        )
    kept = rows.at(inside)
    torques, age = _brought(kept.times, second.times, second.columns[TAU], join)
    out = int(np.count_nonzero(~inside))
    facts = {"join": join, "largest_age": age}
    word = "interpolated linearly" if join == LINEAR else "the last value held"
    report = f"torques at {second.rate:.6g} Hz, {word}, at most {1e3 * age:.3g} ms old"
    if age * second.rate > LATE:
        report += " (warning: the torques have gaps)"
    if out:
        report += f"; {out} rows left out, where there are no torques yet, or no more"
    return replace(kept, columns={**kept.columns, TAU: torques}), facts, report


def _brought(times: Numbers, source: Numbers, values: Array, join: str) -> tuple[Array, float]:
    """The values at other times, and the largest time since the value before [s]."""
    before = np.searchsorted(source, times, side="right") - 1
    age = times - source[before]
    found = values[before]
    if join == LINEAR:
        after = np.minimum(before + 1, len(source) - 1)
        step = np.maximum(source[after] - source[before], 1)
        found = found + (age / step)[:, None] * (values[after] - found)
    return found, 1e-9 * float(age.max())


def _table(name: str, rows: Rows, extra: dict[str, Any]) -> Table:
    """The rows as columns t, q1, q2, ..., from time 0."""
    t = 1e-9 * (rows.times - rows.times[0]).astype(np.float64)
    columns = {"t": t}
    for pattern, values in rows.columns.items():
        for i in range(values.shape[1]):
            columns[pattern.replace("{i}", str(i + 1))] = values[:, i]
    schema = pa.schema([number(column, "s" if column == "t" else None) for column in columns])
    meta = Metadata(extra={**extra, "start_ns": int(rows.times[0])})
    return Table(name, schema, meta, _batches(columns, schema))


def _batches(columns: dict[str, Array], schema: pa.Schema) -> Iterator[pa.RecordBatch]:
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in columns.values()], schema=schema)
    for start in range(0, batch.num_rows, READ_ROWS):
        yield batch.slice(start, READ_ROWS)
