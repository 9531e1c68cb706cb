"""`make faults`: inject every kind of fault, and write the table of outcomes to docs/faults.md.

`python tests/faults/campaign.py [SHARE [SECONDS]]` writes it to standard output; SHARE (1 by default)
scales how many faults are tried, and SECONDS (16) bounds the time of each kind. With FAULTS_SOAK=1 in the environment 100 million rows are streamed too.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from faults import bombs, crafted, damage, processes, settings
from faults.trials import FORBIDDEN, KILLED, REFUSAL, RIGHT, UNNOTICED, Count, Trial, counted

SECONDS = 16.0  # of each class at most
COLUMNS = (RIGHT, REFUSAL, KILLED, UNNOTICED)
TEXT = """# Faults

Exit status 0 means the right result. `make faults` injects faults of many kinds, always the same ones, and
writes this page: how many were tried, and what became of them. "Not noticed by the format" means that the
damaged file is still a file of its format, with other numbers in it: CSV, settings and descriptions of robots have no
checksums; Parquet and Arrow of our own writing and saved states have. "Killed" are runs that got a signal before they
had written anything.

| fault | tried | {columns} | anything else |
|---|---|{bars}|---|
{rows}

Anything else would be exit status 1, an end by a signal that nobody sent, a traceback or several lines, other content
than that of the undamaged file, more than 1 GB of memory or 60 s, and parts of files left behind.

The time of reading grows with the size of a text as follows (seconds at {sizes} MB, with start-up, and the exponent
between the last two):

| text | {sizes} MB | exponent |
|---|---|---|
{times}
{soak}"""


def classes(share: float, seconds: float) -> Iterator[tuple[str, Callable[[], Count]]]:
    """The kinds of faults, by name, and how each is tried."""

    def trials(name: str, made: Iterator[Trial]) -> Count:
        return counted(name, made, seconds)

    for file in damage.names():
        yield f"`{file}` cut", lambda f=file: trials(f"`{f}` cut", damage.cuts(f, int(400 * share)))  # type: ignore[misc]
        name = f"`{file}` with a flipped bit"
        yield name, lambda f=file, n=name: trials(n, damage.flips(f, int(400 * share)))  # type: ignore[misc]
    yield (
        "malformed metadata",
        lambda: trials("malformed metadata", damage.metadata(int(200 * share))),
    )
    for kind, made in crafted.KINDS.items():
        yield kind, lambda k=kind, m=made: trials(k, m(int(300 * share)))  # type: ignore[misc]
    yield "outputs across `then`", lambda: trials("outputs across `then`", crafted.outputs())
    yield "option values", lambda: trials("option values", settings.options(int(500 * share)))
    yield "environments", lambda: trials("environments", settings.environments())
    yield "full disks", lambda: trials("full disks", processes.limits(int(200 * share)))
    yield "closed descriptors", lambda: _closed()
    yield (
        "signals in pipes",
        lambda: _pairs("signals in pipes", processes.interrupted(int(36 * share))),
    )
    yield (
        "concurrent writers",
        lambda: _pairs("concurrent writers", processes.together(max(1, int(5 * share)))),
    )
    if share >= 1.0:
        yield "decompression bombs", lambda: trials("decompression bombs", bombs.bombs())


def _closed() -> Count:
    count = Count("closed descriptors", {}, [])
    for trial in processes.descriptors():
        count.add(processes.closed(trial), f"{trial.name}: {' '.join(trial.words)}")
    return count


def _pairs(name: str, found: Iterator[tuple[str, str]]) -> Count:
    count = Count(name, {}, [])
    for fault, result in found:
        count.add(result, fault)
    return count


def row(count: Count) -> str:
    """A line of the table."""
    rest = (
        ", ".join(f"{n} {what}" for what, n in count.outcomes.items() if what in FORBIDDEN) or "0"
    )
    numbers = " | ".join(str(count.outcomes.get(what, 0)) for what in COLUMNS)
    return f"| {count.name} | {count.tried} | {numbers} | {rest} |"


def soak() -> str:
    """Peak memory of a filter of 100 million rows, if it is asked for."""
    if os.environ.get("FAULTS_SOAK") != "1":
        return ""
    sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
    from memory import peak

    memory, seconds = peak(["filter", "--format", "arrow"], 100_000_000)
    return f"\n100 million rows through `filter`: {memory:.0f} MB, {seconds:.0f} s (`FAULTS_SOAK=1 make faults`).\n"


def main(share: float = 1.0, seconds: float = SECONDS) -> int:
    """Try all, write the page, and say on standard error what must not be."""
    processes.everything_imported()
    counts = []
    for name, tried in classes(share, seconds):
        print(name, file=sys.stderr, flush=True)
        counts.append(tried())
        for example in counts[-1].examples:
            print(f"  {example}", file=sys.stderr, flush=True)
    grown = [f"| {name} | {', '.join(f'{t:.2f}' for t in times)} | {power:.2f} |"
             for name, times, power in bombs.exponents()]  # fmt: skip
    page = TEXT.format(
        columns=" | ".join(COLUMNS),
        bars="|".join("---" for _ in COLUMNS),
        rows="\n".join(map(row, counts)),
        sizes=", ".join(f"{size / 1e6:g}" for size in bombs.SIZES),
        times="\n".join(grown),
        soak=soak(),
    )
    print(page, end="")
    return int(any(count.examples for count in counts))


if __name__ == "__main__":
    sys.exit(main(*map(float, sys.argv[1:])))
