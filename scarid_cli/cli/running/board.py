"""What `scarid watch` shows of a robot that moves: estimates, verdict, rows, and how old they are.

On a terminal rich draws it five times a second, from a thread of its own, so that the age of the
last row grows while no row comes. Elsewhere there is a plain line now and then. The verdict takes
longer than a row may wait: it is found in a thread of its own, of what was known when it began,
and as often as it costs PART of the time.
"""

from __future__ import annotations

import contextlib
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.cli.running.terminal import COLOURS, coloured, is_terminal
from scarid_cli.errors import BadData
from scarid_cli.io.losses import Losses
from scarid_cli.io.table import Table, matrix
from scarid_cli.stages.identify import SoFar

if TYPE_CHECKING:
    from rich.console import RenderableType

HERTZ = 5.0  # of the drawing
PART = 0.05  # of the time, that the verdicts may take
FIRST = 1.0  # s until the first verdict
WITHIN = 3.0  # s, over which the rows of a second are counted
SHOWN = 6  # parameters in a plain line
NAMES = {"32": "green", "33": "yellow", "31": "red"}  # of the colours of a terminal


@dataclass
class Board:
    """What is known so far. Rows change it in one thread, and another one draws it."""

    every: float  # s between plain lines
    clock: Callable[[], float] = time.monotonic
    rows: int = 0
    t: float = np.nan  # s, of the last row
    arrived: float = np.nan  # when it did, by the clock
    late: float = 0.0  # s, that the last row came later than the one that came soonest
    losses: Losses = field(default_factory=Losses)
    parameters: list[tuple[str, str]] = field(default_factory=list)  # names and units
    estimates: Array | None = None
    half: Array | None = None
    verdict: str = ""
    reason: str = "no verdict yet"
    asked: int = 0  # the row up to which the verdict is
    _recent: deque[tuple[float, int]] = field(default_factory=deque)
    _soonest: float = np.inf
    _next: float = np.nan
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _judging: threading.Thread | None = None

    def watched(self, robot: Robot) -> Callable[[SoFar], None]:
        """A function that is offered what is known after each batch of rows."""
        self.parameters = [(p.name, p.unit) for p in robot.parameters]
        return self._watch

    def _watch(self, so_far: SoFar) -> None:
        now = self.clock()
        with self._lock:
            if so_far.batch is not None:
                self._count(so_far.batch, now)
            self._next = self._next if self._next == self._next else now + FIRST
        try:
            estimates = so_far.estimates()
        except (BadData, ValueError):
            return
        with self._lock:
            self.estimates = estimates[: len(self.parameters)]
        if now >= self._next and not self.judging:
            self._judging = threading.Thread(target=self._judge, args=(so_far, now), daemon=True)
            self._judging.start()

    @property
    def judging(self) -> bool:
        """Whether a verdict is being found."""
        return self._judging is not None and self._judging.is_alive()

    def settled(self) -> None:
        """Wait for the verdict that is being found, if one is."""
        if self._judging is not None:
            self._judging.join()

    def _count(self, batch: pa.RecordBatch, now: float) -> None:
        t = matrix(batch, ["t"])[0]
        if not len(t):
            return
        for x in t.tolist():
            self.losses.row(x)
        self.rows, self.t, self.arrived = self.rows + len(t), float(t[-1]), now
        self._soonest = min(self._soonest, now - self.t)
        self.late = now - self.t - self._soonest
        self._recent.append((now, self.rows))
        while len(self._recent) > 2 and now - self._recent[0][0] > WITHIN:
            self._recent.popleft()

    def _judge(self, so_far: SoFar, began: float) -> None:
        rows = self.rows
        try:
            table = so_far.table()
        except (BadData, ValueError) as error:
            verdict, reason, half = "", str(error), None
        else:
            verdict, reason, half = _read(table)
        with self._lock:
            self.verdict, self.reason, self.half = verdict, reason, half
            self.asked = rows
            took = self.clock() - began
            self._next = began + took + max(took / PART, FIRST)

    @property
    def rate(self) -> float:
        """The rows a second of the last seconds."""
        if len(self._recent) < 2:
            return 0.0
        (start, first), (end, last) = self._recent[0], self._recent[-1]
        span = max(end, self.clock() - HERTZ**-1) - start
        return (last - first) / span if span > 0.0 else 0.0

    @property
    def age(self) -> float:
        """How long ago [s] the last row came."""
        return self.clock() - self.arrived

    def state(self) -> str:
        """Time, rows and their age in a line."""
        if not self.rows:
            return "no row yet"
        lost = "" if (told := self.losses_told()) is None else f", {told}"
        return (
            f"t = {self.t:.2f} s, {self.rows:,} rows, {self.rate:.0f} rows/s, the last "
            f"{self.age:.1f} s ago, {1e3 * self.late:.0f} ms late{lost}"
        )

    def losses_told(self) -> str | None:
        """What was lost so far, if anything was."""
        losses = self.losses
        if not (losses.gaps or losses.out_of_order or losses.repeated or losses.restarts):
            return None
        return losses.told()

    def values(self) -> Iterator[tuple[str, str, str, str]]:
        """Name, estimate, half interval and unit of each parameter."""
        if self.estimates is None:
            return
        half = np.full(len(self.parameters), np.nan) if self.half is None else self.half
        for (name, unit), x, h in zip(self.parameters, self.estimates, half, strict=False):
            yield name, f"{x:.4g}", f"{h:.2g}" if np.isfinite(h) else "", unit

    def line(self) -> str:
        """A plain line."""
        with self._lock:
            found = list(self.values())
            shown = [f"{n} {x}{f' +- {h}' if h else ''} {u}".rstrip() for n, x, h, u in found]
            more = [f"{len(found) - SHOWN} more"] if len(found) > SHOWN else []
            verdict = f"; {self.verdict or self.reason}" if self.rows else ""
            return f"{self.state()}{verdict}{': ' if found else ''}" + ", ".join(
                [*shown[:SHOWN], *more]
            )

    def __rich__(self) -> RenderableType:
        from rich.console import Group
        from rich.table import Table as Grid
        from rich.text import Text

        with self._lock:
            grid = Grid("parameter", "estimate", "+-", "unit", box=None, pad_edge=False)
            for column in grid.columns[1:3]:
                column.justify = "right"
            for row in self.values():
                grid.add_row(*row)
            colour = NAMES.get(COLOURS.get(self.verdict, ""), "")
            verdict = Text(self.verdict or "so far", style=f"bold {colour}".strip())
            at = f" (after {self.asked:,} rows)" if self.verdict else ""
            return Group(Text(self.state()), grid, Text.assemble(verdict, f"{at}: {self.reason}"))

    @contextmanager
    def shown(self, *, quiet: bool) -> Iterator[None]:
        """Show the board on standard error for as long as rows may come."""
        with contextlib.ExitStack() as stack:
            stack.callback(self.settled)
            if not quiet:
                stack.enter_context(self._drawn() if is_terminal(2) else self._told())
            yield

    @contextmanager
    def _drawn(self) -> Iterator[None]:
        from rich.console import Console
        from rich.live import Live

        console = Console(stderr=True, no_color=not coloured(2))
        with Live(self, console=console, refresh_per_second=HERTZ, redirect_stdout=False,
                  redirect_stderr=False):  # fmt: skip
            yield

    @contextmanager
    def _told(self) -> Iterator[None]:
        over = threading.Event()

        def tell() -> None:
            while not over.wait(self.every):
                sys.stderr.write(f"scarid watch: {self.line()}\n")
                sys.stderr.flush()

        thread = threading.Thread(target=tell, daemon=True)
        thread.start()
        try:
            yield
        finally:
            over.set()
            thread.join()


def _read(table: Table) -> tuple[str, str, Array | None]:
    """The verdict of a table of parameters, its first reason, and half its 95 % intervals."""
    extra: dict[str, Any] = table.meta.extra
    rows = [row for batch in table.batches for row in batch.to_pylist()]
    half = np.array([0.5 * (row["high"] - row["low"]) for row in rows], dtype=np.float64)
    return str(extra["verdict"]), str(extra["reasons"][0]), half
