"""A small table as a person reads it: numbers rounded to what is known of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from math import floor, inf, isfinite, log10
from typing import Any

import pyarrow as pa

from scarid_cli.interval import HALF
from scarid_cli.reporting.parts import NONE, Section
from scarid_cli.reporting.text import terminal

DIGITS = 4  # of a number whose error is not known
KNOWN = 2  # digits of an error, to which the estimate is rounded


def readable(title: str, table: pa.Table) -> str:
    """The table for the window of the terminal."""
    names, rows = table.column_names, table.to_pylist()
    if {"parameter", "estimate", "robust_error"} <= set(table.column_names):
        return terminal([_parameters(title, rows)])
    words = takewhile(pa.types.is_string, table.schema.types)
    lines = tuple(tuple(_text(row[name]) for name in names) for row in rows)
    return terminal([Section(title, "", tuple(names), lines, texts=len(list(words)))])


def _parameters(title: str, rows: Sequence[dict[str, Any]]) -> Section:
    """Each estimate with half its 95 % interval, both to the second digit of this half.

    An interval that contains 0 has no percentage: its half says what is known.
    """
    headers = ("parameter", "unit", "estimate", "+-", "%", "low", "high")
    lines = []
    for row in rows:
        half = _half(row)
        places = KNOWN - 1 - floor(log10(half)) if half else None
        numbers = (_rounded(row[key], places) for key in ("estimate", "low", "high"))
        estimate, low, high = numbers
        share = half / abs(row["estimate"]) if half and row["estimate"] else inf
        size = _rounded(half, places)
        part = _two_digits(100.0 * share) if share <= 1.0 else NONE
        lines.append((row["parameter"], row["unit"] or NONE, estimate, size, part, low, high))
    note = "+- is half the 95 % interval, from low to high; % is +- in percent of the estimate."
    return Section(title, note, headers, tuple(lines), texts=2)


def _half(row: dict[str, Any]) -> float | None:
    """Half the 95 % interval, if it is known; without one, by the standard error."""
    if row.get("low") is not None and row.get("high") is not None:
        half = 0.5 * float(row["high"] - row["low"])
    else:
        half = HALF * float(row["robust_error"] or row["standard_error"] or 0.0)
    return half if isfinite(half) and half > 0.0 else None


def _two_digits(value: float) -> str:
    return f"{value:.0f}" if value >= 10.0 else f"{value:.2g}"


def _rounded(value: float | None, places: int | None) -> str:
    """A number with so many decimal places, fewer than none being zeros; or a few digits."""
    if value is None or not isfinite(value):
        return NONE
    if places is None or abs(value) >= 1e6 or places > 9:
        return f"{value:.{DIGITS}g}"
    return f"{round(value, places):.{max(places, 0)}f}"


def _text(value: Any) -> str:
    if value is None:
        return NONE
    if isinstance(value, float):
        return f"{value:.{DIGITS}g}"
    return ("yes" if value else "no") if isinstance(value, bool) else str(value)
