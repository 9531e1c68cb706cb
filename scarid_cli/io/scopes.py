"""Exports that say of each channel what they know, a line for each property, above their table.

TwinCAT Scope writes two cells for each channel, the first of which is the property: `Name`, `Unit`
and others; below are a time in milliseconds and a value. LabVIEW's .lvm files have the properties
in their first cells, and the names behind the end of the header.
"""

from __future__ import annotations

from collections.abc import Sequence

NAME, UNIT, NONE = "Name", "Unit", ("", "(None)", "None")
TIME = "Time [ms]"
END_OF_HEADER, LABEL = "***End_of_Header***", "Y_Unit_Label"  # of LabVIEW
X, SECONDS = "X_Value", "Time [s]"

Rows = Sequence[Sequence[str]]


def channels(rows: Rows) -> tuple[str, ...]:
    """The names of the columns below these rows, the last of which is the nearest.

    They are empty if the rows are not those of such an export.
    """
    return _twincat(rows) or _labview(rows)


def _twincat(rows: Rows) -> tuple[str, ...]:
    own = rows[-1]
    if not _alternates(own):
        return ()
    known = {row[0]: row[1::2] for row in rows if len(row) == len(own) and _alternates(row)}
    if NAME not in known:
        return ()
    units = known.get(UNIT, [""] * (len(own) // 2))
    pairs = zip(known[NAME], units, strict=True)
    return tuple(text for name, unit in pairs for text in (TIME, _with_unit(name, unit)))


def _alternates(row: Sequence[str]) -> bool:
    return len(row) >= 4 and len(row) % 2 == 0 and len({*row[::2]}) == 1


def _labview(rows: Rows) -> tuple[str, ...]:
    own = rows[-1]
    if own[0] != X or not any(row[0] == END_OF_HEADER for row in rows if row):
        return ()
    units = next((row for row in rows if row and row[0] == LABEL), [])
    every = [*units, *[""] * len(own)][: len(own)]
    named = zip(own, every, strict=True)
    return tuple(SECONDS if name == X else _with_unit(name, unit) for name, unit in named)


def _with_unit(name: str, unit: str) -> str:
    return name if unit.strip() in NONE else f"{name} [{unit.strip()}]"
