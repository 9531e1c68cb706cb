"""The failures that a command reports, each with its documented exit status."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

OK = 0
BUG = 1
WARNED = 1  # of `check --strict`
USAGE = 2
REQUIRED = 3  # the verdict is not what --require asks for
BAD_DATA = 65
IO_FAILURE = 74
INTERRUPTED = 130
BROKEN_PIPE = 141

CORRECT = "correct or remove the row"


class ScaridError(Exception):
    """A failure that is reported in one line: where it is, what was found, and what to do."""

    status = BAD_DATA


class UsageFault(ScaridError):
    """The command line asks for something impossible (exit status 2)."""

    status = USAGE


class BadData(ScaridError):
    """The input is not what the command needs (exit status 65)."""

    status = BAD_DATA


class TooShort(BadData):
    """A record, or a segment of it, has fewer rows than the method needs."""


class ForeignLog(BadData):
    """A log, of the kind that `what` says, which `scarid convert` reads, with these `words`."""

    def __init__(self, name: str, what: str = "", words: Sequence[str] = ()) -> None:
        import shlex  # only now: every command imports this module

        self.name, self.what = name, what
        convert = " ".join(["scarid convert", *words, shlex.quote(name), "-o log.parquet"])
        super().__init__(f"{name}: {f'{what}; ' if what else ''}convert it first: `{convert}`")


class OutputFailure(ScaridError):
    """Reading or writing failed (exit status 74)."""

    status = IO_FAILURE


def bad_data(
    where: str,
    found: str,
    *,
    expected: str,
    remedy: str,
    row: int | None = None,
    column: str | None = None,
) -> BadData:
    """Bad data, reported in one line: the file, the row (from 1), the column, and what to do."""
    place = [where]
    if row is not None:
        place.append(f"row {row}")
    if column is not None:
        place.append(f"column {column}")
    return BadData(f"{', '.join(place)}: found {found}, expected {expected}; {remedy}")


def bad_row(where: str, found: str, expected: str, row: int, column: str | None = None) -> BadData:
    """Bad data in one row (from 1), which nothing but its source can mend."""
    return bad_data(where, found, expected=expected, remedy=CORRECT, row=row, column=column)


def cut_short(where: str) -> BadData:
    """The error for a table that is incomplete, because the command that wrote it failed."""
    return BadData(f"{where}: the table was cut short, because the command that wrote it failed")
