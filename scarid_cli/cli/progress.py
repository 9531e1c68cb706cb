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


def counted(batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
    """Pass batches on, and show how many rows they had."""
    start = time.monotonic()
    held = 0
    for batch in batches:
        yield batch
        held += batch.num_rows
        if time.monotonic() - start > SHOWN_AFTER:
            break
    else:
        return
    with _line("{task.completed:,.0f} rows", held) as advance:
        for batch in batches:
            yield batch
            advance(batch.num_rows)


@contextlib.contextmanager
def _line(text: str, completed: int = 0) -> Iterator[Callable[[int], None]]:
    """A progress line with this text, and the function that counts on."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn(text), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task("", total=None, completed=completed)
        yield lambda count: progress.advance(task, count)
