"""A number as CSV has it, and rows of texts as CSV."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Sequence

# Integers with more digits (nanosecond time stamps) do not fit into a double, and stay text.
NUMERIC = re.compile(r"\s*[+-]?(\d{1,15}|\d*\.\d+|\d+\.\d*)([eE][+-]?\d+)?\s*\Z")

# How programs write a missing number; in a table with a column of text they are texts.
MISSING = ("NA", "N/A", "n/a", "#N/A", "null", "NULL", "None")


def decoded(block: bytes) -> str:
    """The text of whole lines: in UTF-8, or as Windows writes it in the west if it is not that."""
    try:
        return block.decode("utf-8-sig")
    except UnicodeDecodeError:
        return block.decode("cp1252", errors="replace")


def csv_text(rows: Sequence[Sequence[str]]) -> bytes:
    """Rows of texts as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()
