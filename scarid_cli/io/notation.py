"""How a text log is written, found from its first lines: separator, decimal comma, header."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from scarid_cli.errors import UsageFault
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.cells import MISSING, NUMERIC, decoded
from scarid_cli.io.echoed import joint_state_names
from scarid_cli.io.scopes import channels

LONG = re.compile(r"\s*[+-]?\d+\s*\Z")  # an integer of any length, as of nanoseconds
SPACE = " "  # any white space between values
SEPARATORS = (",", ";", "\t", "|", SPACE)
NAMES = {",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", SPACE: "white space"}
LOOKED_AT = 8  # lines of a table, if there are so many, which must be alike
ROWS = 3  # lines that are looked at: a header, if there is one, and rows
MOST_LINES = 10_000  # that are looked at for them, among comments and empty lines
LATEST = 64  # rows that may stand before the header: what a program says of its file
NOTHING = {"", "-", "nan", *(text.lower() for text in MISSING)}  # in place of a value
COMMENT = "#%"  # with which a comment begins
DECIMAL_COMMA = re.compile(r"\s*[+-]?\d*,\d+([eE][+-]?\d+)?\s*\Z")


@dataclass(frozen=True)
class Notation:
    """The separator (SPACE for any white space), the decimal mark, and the names of the columns.

    The names are empty if the file has a header, and `comment` says that it is a comment. `skip`
    lines stand before the header. If the line behind it has `units`, it has them in its names; a
    header of `two_lines` has the second parts of the names there.
    """

    separator: str = ","
    decimal_comma: bool = False
    header: tuple[str, ...] = ()
    comment: bool = False
    skip: int = 0
    units: tuple[str, ...] = ()
    two_lines: bool = False

    @property
    def plain(self) -> bool:
        """Whether this is CSV as every command reads it."""
        return self == Notation()

    @property
    def text(self) -> str:
        """In words, for a report."""
        parts = [f"values separated by {NAMES[self.separator]}"]
        parts += ["decimal commas"] if self.decimal_comma else []
        if self.skip:
            parts.append(f"after {self.skip} lines that are no table")
        if self.units:
            parts.append(f"units in the second line: {', '.join(filter(None, self.units))}")
        elif self.two_lines:
            parts.append(f"names in two lines: {','.join(self.header)}")
        elif self.header:
            names = ",".join(self.header)
            parts.append(f"names from a comment: {names}" if self.comment else f"columns {names}")
        return ", ".join(parts)


def notation_of(source: ByteSource, given: Notation | None, *, by_name: bool) -> Notation:
    """The notation of a text log; what is `given` on the command line is not looked for.

    The columns of a log without names are called after the file if they are to be renamed
    `by_name`; else a log without names is refused.
    """
    comments, lines, skip, above = _first_lines(source)
    given = given or Notation(separator="")
    found = given if given.separator else _looked_at(lines, source.name)
    separator, comma = found.separator, found.decimal_comma
    if given.header or not lines:
        return Notation(separator, comma, given.header, skip=skip)
    fields = split(lines[0], separator)
    if separator == "," and (echoed := joint_state_names(fields)):
        return Notation(separator, comma, echoed)
    if not all(is_number(field, comma=comma) for field in fields):
        for count in (2, 1):  # the first line may be one of several that are above the numbers
            rows = [split(line, separator) for line in (*above, *lines[:count])]
            if not is_number(rows[-1][0], comma=comma) and (of_channels := channels(rows)):
                return Notation(separator, comma, of_channels, skip=skip + count)
        units = _units(lines, separator, comma=comma)
        header = tuple(name.strip() for name in fields) if units else ()
        if units and len({*header}) < len(header):
            return Notation(separator, comma, _joined(header, units), skip=skip, two_lines=True)
        return Notation(separator, comma, header, skip=skip, units=units)
    names = split(comments[-1].lstrip("#% "), separator) if comments else []
    if len(names) == len(fields) and not any(is_number(n, comma=comma) for n in names):
        return Notation(
            separator, comma, tuple(name.strip() for name in names), comment=True, skip=skip
        )
    if by_name:
        header = tuple(f"{_stem(source.name)}{i + 1}" for i in range(len(fields)))
        return Notation(separator, comma, header, skip=skip)
    raise without_names(source.name, len(fields))


def without_names(name: str, columns: int) -> UsageFault:
    """What to say of a file whose columns have no names."""
    stem = _stem(name)
    return UsageFault(
        f"{name}: no header: the first line is a row of {columns} numbers; name them: "
        f"--header {_example(columns)}, or call them {stem}1, {stem}2, ... and rename them: "
        f"--map 'q*={stem}'"
    )


def _stem(name: str) -> str:
    return Path(name).stem.partition(".")[0].strip("<>")


def split(line: str, separator: str) -> list[str]:
    """The values of a line."""
    if separator == SPACE:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator), [])
    except csv.Error:  # a value that is too long, which reading will report
        return line.split(separator)


def is_number(text: str, *, comma: bool) -> bool:
    return bool(NUMERIC.match(text.replace(",", ".") if comma else text) or LONG.match(text))


def _units(lines: Sequence[str], separator: str, *, comma: bool) -> tuple[str, ...]:
    """The second line, if it states units: no numbers, and some behind it."""
    if len(lines) < ROWS:
        return ()
    second, third = (split(line, separator) for line in lines[1:3])
    if len(second) != len(third) or any(is_number(field, comma=comma) for field in second):
        return ()
    numbers = sum(is_number(field, comma=comma) for field in third)
    stated = tuple(field.strip().strip("[]()") for field in second)
    return stated if any(stated) and 2 * numbers > len(third) else ()


def _joined(first: Sequence[str], second: Sequence[str]) -> tuple[str, ...]:
    """Names from two lines, as `position.elbow`; an empty cell has the word to its left."""
    words, left = [], ""
    for word in first:
        left = word or left
        words.append(left)
    pairs = zip(words, second, strict=True)
    return tuple(".".join(filter(None, pair)) for pair in pairs)


def _first_lines(source: ByteSource) -> tuple[list[str], list[str], int, list[str]]:
    """The comments before the table, its first lines, and how many lines are before both.

    The last are those lines, as far as they are not empty.
    """
    count, skip, above = LOOKED_AT, 0, list[str]()
    while True:
        block = source.peek_lines(count)
        text = _lines(decoded(block))[:count]
        rows = [i for i, line in enumerate(text) if line.strip() and line[0] not in COMMENT]
        complete = len(text) < count or count > MOST_LINES
        start = _start([text[i] for i in rows], complete=complete or len(rows) > LATEST)
        if start is not None or complete or len(rows) > LATEST:
            break
        count *= 2
    if start:
        skip, above = rows[start], [text[i] for i in rows[:start]]
        text, rows = text[skip:], [i - skip for i in rows[start:]]
    text = text[: rows[:ROWS][-1] + 1] if len(rows) >= ROWS else text
    comments = [line for line in text if line.startswith(tuple(COMMENT))]
    return comments, [text[i] for i in rows[:ROWS]], skip, above


def _lines(text: str) -> list[str]:
    """The lines of a text; str.splitlines takes other characters for ends of lines as well."""
    lines = [line.removesuffix("\r") for line in text.split("\n")]
    return lines if lines[-1] else lines[:-1]


def _start(lines: Sequence[str], *, complete: bool) -> int | None:
    """The line with which a table begins: as many values as in the next ones, these numbers.

    The one behind it may have units. As many as LOOKED_AT lines are looked at, unless these lines
    are `complete`: what a program says of its channels has numbers in some lines, too.
    """
    for most in (LOOKED_AT, ROWS) if complete else (LOOKED_AT,):
        least = ROWS if complete else most
        for at in range(min(len(lines) - least + 1, LATEST)):
            if any(_is_table(lines[at : at + most], separator) for separator in SEPARATORS):
                return at
    return None


def _is_table(lines: Sequence[str], separator: str) -> bool:
    """Whether the lines have as many values each, and those from the third on mostly numbers."""
    rows = [split(line, separator) for line in lines]
    if len({len(row) for row in rows}) > 1 or len(rows[0]) < 2:
        return False
    found = 0
    for row in rows[ROWS - 1 :]:
        there = [field for field in row if field.strip().lower() not in NOTHING]
        numbers = sum(is_number(field.replace(",", "."), comma=False) for field in there)
        if there and 2 * numbers <= len(there):
            return False
        found += numbers
    return found > 0


def _looked_at(lines: Sequence[str], name: str) -> Notation:
    """The separator with which most values of the rows are numbers, and the decimal mark."""
    rows = lines[1:] or lines
    best, most, comma = ",", -1.0, False
    for separator in SEPARATORS:
        counts = [len(split(line, separator)) for line in lines]
        if not counts or counts[0] < 2 or any(a != b for a, b in pairwise(counts)):
            continue
        fields = _fields(rows, separator)
        commas = separator != "," and any(DECIMAL_COMMA.match(field) for field in fields)
        share = sum(is_number(field, comma=commas) for field in fields) / len(fields)
        if share > most:
            best, most, comma = separator, share, commas
    if comma and any("." in f and NUMERIC.match(f) for f in _fields(rows, best)):
        raise UsageFault(
            f"{name}: decimal commas and decimal points in the same rows; say which marks the "
            f"decimals: --separator '{best}', and --decimal-comma for the comma"
        )
    return Notation(best, comma)


def _fields(rows: Sequence[str], separator: str) -> list[str]:
    return [field for line in rows for field in split(line, separator)]


def _example(columns: int) -> str:
    """A header for as many columns, of a log of positions and torques if the number suits."""
    joints, rest = divmod(columns - 1, 2)
    if rest or not joints:
        return f"t,q1,... ({columns} names)"
    return ",".join(["t", *(f"{s}{i + 1}" for s in ("q", "tau") for i in range(joints))])
