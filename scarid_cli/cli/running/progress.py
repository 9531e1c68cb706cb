"""A progress line on a terminal, for runs that take more than a second."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pyarrow as pa

SHOWN_AFTER = 1.0  # seconds before anything is shown


@contextlib.contextmanager
def steps(
    *,
    quiet: bool,
    of: str = "settings tried",
    total: int | None = None,
    within: float | None = None,
) -> Iterator[Callable[[], None]]:
    """A function to call at each step of a search, counted where a person waits.

    The remaining time is shown if the number of steps is known (`total`), or their time (`within`,
    in seconds).
    """
    if quiet or not sys.stderr.isatty():
        yield lambda: None
        return
    begun = time.monotonic()
    done = 0
    behind = ("{task.fields[left]} left",) if total or within else ()
    start = _clock(within) if within else "?"
    with _line(f"{{task.completed}} {of}", behind=behind, left=start) as update:

        def step() -> None:
            nonlocal done
            done += 1
            passed = time.monotonic() - begun
            left = passed * (total / done - 1.0) if total else (within or 0.0) - passed
            update(advance=1, left=_clock(max(left, 0.0)))

        yield step


def counted(
    batches: Iterator[pa.RecordBatch],
    length: int | None,
    part_read: Callable[[], float | None],
    note: Callable[[], str] = str,
) -> Iterator[pa.RecordBatch]:
    """Pass batches on, and show how many rows they had.

    The percentage and the remaining time are shown as well, by the number of all rows (`length`) if
    it is known, else by the part of the input that was read. A `note` stands at the end.
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
        show(part(held), held, note())
        for batch in batches:
            yield batch
            held += batch.num_rows
            show(part(held), held, note())


@contextlib.contextmanager
def _bar(
    text: str, *, known: bool, since: float
) -> Iterator[Callable[[float | None, int, str], None]]:
    """A progress line, with a percentage if the end is `known`; `since` [s] it has been running.

    The function takes the part that is done, the number of rows, and a note.
    """
    texts = ("{task.fields[percent]:.0f} %", text) if known else (text,)
    behind = (*(("{task.fields[left]} left",) if known else ()), "{task.fields[note]}")
    with _line(*texts, behind=behind, rows=0, percent=0.0, left="?", note="") as update:
        begun = time.monotonic() - since

        def show(part: float | None, rows: int, note: str) -> None:
            left = (time.monotonic() - begun) * (1.0 / part - 1.0) if part else 0.0
            update(rows=rows, percent=100.0 * (part or 0.0), left=_clock(left), note=note)

        yield show


def _clock(seconds: float) -> str:
    """A duration as hours, minutes and seconds."""
    minutes, second = divmod(round(seconds), 60)
    hours, minute = divmod(minutes, 60)
    return f"{hours}:{minute:02}:{second:02}"


@contextlib.contextmanager
def _line(*texts: str, behind: Sequence[str] = (), **fields: Any) -> Iterator[Callable[..., None]]:
    """A progress line with these texts, the time so far, and the texts `behind` it.

    The function changes the `fields` that the texts show, or counts on (`advance`).
    """
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (
        SpinnerColumn(),
        *map(TextColumn, texts),
        TimeElapsedColumn(),
        *map(TextColumn, behind),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        yield partial(progress.update, progress.add_task("", total=None, **fields))
