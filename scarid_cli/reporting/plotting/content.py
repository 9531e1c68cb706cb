"""What `scarid plot` draws of a table: curves over time, spectra, or values with intervals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from math import nan

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, UsageFault, bad_data, bad_row
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, matrix, segments_of, settled
from scarid_cli.printable import printable
from scarid_cli.reporting.curves import Curve
from scarid_cli.reporting.parts import Panel, Panels, Range, Ranges, Series
from scarid_cli.reporting.plotting.columns import Group, groups
from scarid_cli.reporting.plotting.spectrum import Spectrum
from scarid_cli.reporting.wording import with_unit

VALUES = {"estimate": ("parameter", "quantity"), "gain": ("joint",)}  # and what names each of them
LISTS = ("comparison", "expected", "gains", "metrics", "parameters", "payload", "published",
         "trials", "via")  # fmt: skip
TIME = "t [s]"

Clock = Callable[[Table], Table]


def kind_of(table: Table) -> str | None:
    """The kind that the table states, else that which its columns fit."""
    detected = schemas.detect(table.columns)
    return table.meta.kind or (detected.kind if detected else None)


def content(table: Table, wanted: Sequence[str], regular: Clock | None) -> Panels | Ranges:
    """The plot of a table; of the `wanted` columns only, if there are any.

    With `regular`, which checks the clock, spectra are drawn.
    """
    kind = kind_of(table)
    value = next((name for name in VALUES if {name, "low", "high"} <= {*table.columns}), None)
    if value and not wanted and not regular:
        return _ranges(table, value)
    if kind in LISTS and not wanted:
        raise UsageFault(
            f"{table.name}: a {kind} table has neither times nor intervals to draw; "
            "`scarid report` and `scarid info` print tables, and --columns draws columns over rows"
        )
    chosen = groups(table, kind, wanted)
    if not chosen:
        raise bad_data(
            table.name,
            f"the columns {', '.join(map(printable, table.columns))}",
            expected="a column of numbers beside the time",
            remedy="`scarid info` describes the table",
        )
    if regular:
        return _spectra(table, chosen, regular)
    return _curves(table, chosen, residuals=kind == "prediction")


def _ranges(table: Table, value: str) -> Ranges:
    """Each value with its interval; rows whose value is missing are left out."""
    named = next((name for name in VALUES[value] if name in table.columns), None)
    rows = [row for batch in table.batches for row in batch.to_pylist()]
    found = [
        Range(
            printable(f"joint {row[named]}" if named == "joint" else str(row[named or value])),
            printable(str(row.get("unit") or "")),
            *(float(x) if (x := row[key]) is not None else nan for key in (value, "low", "high")),
        )
        for row in rows
        if row[value] is not None
    ]
    if not found:
        raise _nothing(table, "no rows", "at least one value")
    return Ranges(_caption(table, len(rows)), tuple(found))


@dataclass
class _Reading:
    """The curves of columns while a table is read, and its extent."""

    columns: list[str]
    pairs: list[tuple[str, str]]
    rows: int = 0
    times: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.curves = {name: Curve() for name in self.columns}
        self.curves |= {_difference(*pair): Curve() for pair in self.pairs}

    def add(self, t: Array, values: Array) -> None:
        """Add the next rows; values that are missing leave a gap."""
        signals = dict(zip(self.columns, values, strict=True))
        signals |= {_difference(a, b): signals[a] - signals[b] for a, b in self.pairs}
        for name, x in signals.items():
            known = np.isfinite(t) & np.isfinite(x)
            self.curves[name].add(t[known], x[known])
        self.rows += len(t)
        known = t[np.isfinite(t)].tolist()
        self.times = [*(self.times[:1] or known[:1]), *(known[-1:] or self.times[1:])]


def _curves(table: Table, chosen: Sequence[Group], *, residuals: bool) -> Panels:
    timed = "t" in table.columns and pa.types.is_floating(table.schema.field("t").type)
    columns = [name for group in chosen for name in group.columns]
    pairs = [_residual(group) for group in chosen] if residuals else []
    reading = _Reading(columns, [pair for pair in pairs if pair])
    for batch in settled(table.batches):
        rows = np.arange(reading.rows, reading.rows + batch.num_rows, dtype=np.float64) + 1.0
        t = matrix(batch, ["t"])[0] if timed else rows
        reading.add(t, matrix(batch, columns))
    points = {name: curve.points() for name, curve in reading.curves.items()}
    if not any(curve.size for curve in points.values()):
        found = f"{reading.rows:,} rows without a value" if reading.rows else "no rows"
        raise _nothing(table, found, "at least one value")
    panels: list[Panel] = []
    for group in chosen:
        panels.append(_panel(table, group.columns, points))
        if residuals and (pair := _residual(group)):
            panels.append(_panel(table, [_difference(*pair)], points, pair[0]))
    return Panels(
        _caption(table, reading.rows, reading.times if timed else []),
        tuple(panels),
        _columns(chosen) * (2 if residuals else 1),
        across=TIME if timed else "row",
    )


def _panel(
    table: Table, names: Sequence[str], points: dict[str, Array], like: str | None = None
) -> Panel:
    """The curves of a panel; the unit is that of the first, or of the column that it is `like`."""
    shown = [printable(name) for name in names]
    curves = zip(shown, names, strict=True)
    series = tuple(Series(text, k, points[name]) for k, (text, name) in enumerate(curves))
    return Panel(with_unit(shown[0], _unit(table, like or names[0])), series)


def _unit(table: Table, column: str) -> str:
    return printable(table.unit(column) or "")


def _residual(group: Group) -> tuple[str, str] | None:
    """The measured and the predicted torque of a panel."""
    measured, *others = group.columns
    return next(((measured, name) for name in others if name == f"{measured}_pred"), None)


def _difference(first: str, second: str) -> str:
    return f"{first} - {second}"


def _columns(chosen: Sequence[Group]) -> int:
    """As many panels beside each other as each joint has, if all have the same signals."""
    joints = {group.joint for group in chosen}
    each = len(chosen) // len(joints)
    rows = [chosen[i : i + each] for i in range(0, len(chosen), each)]
    alike = all(len({g.joint for g in row}) == 1 and row[0].joint for row in rows)
    same = len({tuple(g.signal for g in row) for row in rows}) == 1
    return each if alike and same else 1


def _spectra(table: Table, chosen: Sequence[Group], regular: Clock) -> Panels:
    columns = [name for group in chosen for name in group.columns]
    if "t" not in table.columns:
        raise UsageFault(f"{table.name}: --spectrum needs the time in a column t")
    checked = regular(table)
    spectrum = Spectrum(len(columns), checked.period)
    rows, last = 0, None
    for batch in settled(checked.batches):
        values = matrix(batch, columns)
        _require_values(values, columns, table, rows)
        numbers = segments_of(batch)
        if last is not None and numbers[0] != last:
            spectrum.gap()
        spectrum.add(values)
        rows, last = rows + batch.num_rows, numbers[-1]
    frequencies, densities = spectrum.density()
    if not len(frequencies):
        raise _nothing(table, f"{rows:,} rows", "a part of the record that is long enough")
    points = {
        name: np.stack([frequencies, np.where(density > 0.0, density, np.nan)])
        for name, density in zip(columns, densities, strict=True)
    }
    panels = (_panel(table, group.columns, points) for group in chosen)
    rate = f"{1.0 / checked.period:.6g} Hz"
    return Panels(
        f"{_caption(table, rows)}, {rate}, amplitude density",
        tuple(replace(panel, axis=_density(panel.axis)) for panel in panels),
        _columns(chosen),
        across="frequency [Hz]",
        logarithmic=True,
    )  # fmt: skip


def _density(axis: str) -> str:
    """The unit of an amplitude density."""
    return f"{axis[:-1]}/√Hz]" if axis.endswith("]") else axis


def _require_values(values: Array, columns: Sequence[str], table: Table, rows: int) -> None:
    missing = ~np.isfinite(values)
    if missing.any():
        column, row = np.argwhere(missing)[0]
        place = rows + int(row) + 1
        raise bad_row(table.name, "no value", "a finite number", place, columns[column])


def _caption(table: Table, rows: int, times: Sequence[float] = ()) -> str:
    """The name of the table, its kind, its rows and its time."""
    kind = kind_of(table)
    parts = [kind or "table", f"{rows:,} row{'s' if rows != 1 else ''}"]
    parts += [f"{times[0]:.6g} s to {times[-1]:.6g} s"] if times else []
    return f"{printable(table.name)}: {', '.join(parts)}"


def _nothing(table: Table, found: str, expected: str) -> BadData:
    remedy = "check that the command that wrote the table has succeeded"
    return bad_data(table.name, found, expected=expected, remedy=remedy)
