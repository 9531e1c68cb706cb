"""A progress line on a terminal, for runs that take more than a second."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pyarrow as pa

SHOWN_AFTER = 1.0  # seconds before anything is shown


@contextlib.contextmanager
def steps(*, quiet: bool, of: str = "settings tried") -> Iterator[Callable[[], None]]:
    """A function to call at each step of a search, counted where a person waits."""
    if quiet or not sys.stderr.isatty():
        yield lambda: None
        return
    with _line(f"{{task.completed}} {of}") as advance:
        yield lambda: advance(1)


def counted(
    batches: Iterator[pa.RecordBatch],
    length: int | None,
    part_read: Callable[[], float | None],
) -> Iterator[pa.RecordBatch]:
    """Pass batches on, and show how many rows they had.

    The percentage and the remaining time are shown as well, by the number of all rows (`length`) if
    it is known, else by the part of the input that was read.
    """
    start = time.monotonic()
    held = 0
    for batch in batches:
        yield batch
        held += batch.num_rows
        if time.monotonic() - start > SHOWN_AFTER:
            break
    else:
        return

    def part(rows: int) -> float | None:
        return rows / length if length else part_read()

    text = "{task.fields[rows]:,} rows"
    with _bar(text, known=part(held) is not None, since=time.monotonic() - start) as show:
        show(part(held), held)
        for batch in batches:
            yield batch
            held += batch.num_rows
            show(part(held), held)


@contextlib.contextmanager
def _bar(text: str, *, known: bool, since: float) -> Iterator[Callable[[float | None, int], None]]:
    """A progress line, with a percentage if the end is `known`; `since` [s] it has been running.

    The function takes the part that is done, and the number of rows.
    """
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = [SpinnerColumn(), TextColumn(text), TimeElapsedColumn()]
    if known:
        columns.insert(1, TextColumn("{task.fields[percent]:.0f} %"))
        columns.append(TextColumn("{task.fields[left]} left"))
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        begun = time.monotonic() - since
        task = progress.add_task("", total=None, rows=0, percent=0.0, left="?")

        def show(part: float | None, rows: int) -> None:
            left = (time.monotonic() - begun) * (1.0 / part - 1.0) if part else 0.0
            progress.update(task, rows=rows, percent=100.0 * (part or 0.0), left=_clock(left))

        yield show


def _clock(seconds: float) -> str:
    """A duration as hours, minutes and seconds."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}"


@contextlib.contextmanager
def _line(text: str) -> Iterator[Callable[[int], None]]:
    """A progress line with this text, and the function that counts on."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn(text), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=None)
        yield lambda count: progress.advance(task, count)
