"""The options that choose the rows of a log."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from scarid_cli.cli.declaring.headings import DATA, heading
from scarid_cli.cli.declaring.options import FINITE, Number, all_of
from scarid_cli.errors import UsageFault

if TYPE_CHECKING:
    from scarid_cli.io.selection import Selection

F = TypeVar("F", bound=Callable[..., Any])


def first_and_last(rows: str) -> tuple[int, int | None] | None:
    """The rows that `A:B` names, counted from 1; None if this names none."""
    first, colon, last = rows.partition(":")
    if not colon or not all(part.isdecimal() or not part for part in (first, last)):
        return None
    low, high = int(first or 1), int(last) if last else None
    return (low, high) if low >= 1 and (high is None or high >= low) else None


class Rows(click.ParamType[str]):
    """`A:B`, the rows from A to B of a log, counted from 1; A or B may be left out."""

    name = "rows"

    def convert(self, value: Any, param: Any, ctx: Any) -> str:
        if first_and_last(str(value)) is None:
            text = f"{value!r}: give the first and the last row, counted from 1, such as 100:5000, "
            self.fail(f"{text}100: or :5000", param, ctx)
        return str(value)


def window(function: F) -> F:
    """Which part of a log is read."""
    return all_of(
        heading(DATA),
        click.option(
            "--from-time", type=Number(FINITE), metavar="S",
            help="Read the log from this time on [s].",
        ),
        click.option(
            "--to-time", type=Number(FINITE), metavar="S",
            help="Read the log up to this time [s].",
        ),
        click.option(
            "--rows", type=Rows(), metavar="A:B",
            help="Read rows A to B only, counted from 1.",
        ),
    )(function)  # fmt: skip


def selection(function: F) -> F:
    """Which part of a log is read, and what becomes of rows that lack a value."""
    return all_of(
        heading(DATA),
        window,
        click.option(
            "--missing", type=click.Choice(("refuse", "drop", "split", "fill")), default="refuse",
            show_default=True,
            help="What to do where a value is missing: refuse the log; drop the row; split, which "
            "also begins a new segment after it, as after a gap; or fill, for sources that write "
            "in turn: keep the rows with q1, and interpolate the other columns there (holds the "
            "log in memory).",
        ),
    )(function)  # fmt: skip


def selection_of(given: dict[str, Any]) -> Selection:
    """The rows to read, by these options of a command, if it has them."""
    from scarid_cli.io.selection import REFUSE, Selection  # numpy, which `--help` does not need

    first, last = first_and_last(given.get("rows") or ":") or (1, None)
    start, end = given.get("from_time"), given.get("to_time")
    if start is not None and end is not None and end <= start:
        raise UsageFault(f"--to-time {end:g} is not after --from-time {start:g}; give a later time")
    return Selection(start, end, first, last, given.get("missing") or REFUSE)
