"""A small table as a person reads it: numbers rounded to what is known of them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile
from math import floor, isfinite, log10
from typing import Any

import pyarrow as pa

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
    """Each estimate with its error, both to the second digit of the error."""
    headers = ("parameter", "unit", "estimate", "+-", "%", "low", "high")
    lines = []
    for row in rows:
        error = row["robust_error"] or row["standard_error"]
        known = error is not None and isfinite(error) and error > 0.0
        places = KNOWN - 1 - floor(log10(error)) if known else None
        numbers = (_rounded(row[key], places) for key in ("estimate", "low", "high"))
        estimate, low, high = numbers
        share = abs(100.0 * error / row["estimate"]) if known and row["estimate"] else None
        size = _rounded(error, places)
        part = NONE if share is None else f"{share:.0f}" if share >= 10.0 else f"{share:.2g}"
        lines.append((row["parameter"], row["unit"] or NONE, estimate, size, part, low, high))
    return Section(title, "", headers, tuple(lines), texts=2)


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
