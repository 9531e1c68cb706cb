"""How the tables of a report were made: every command once, in an order in which they can run."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scarid_cli.io.bytesource import STDIN
from scarid_cli.io.table import Table
from scarid_cli.printable import printable

# The option that writes a table of these kinds beside the output of the command.
BESIDE = {"prediction": "--predictions", "trace": "--trace"}
# A command needs the tables that the commands before it in this list write.
STEPS = (
    "trajgen",
    "simulate",
    "convert",
    "resample",
    "filter",
    "tune",
    "differentiate",
    "identify",
)


@dataclass(frozen=True)
class Origins:
    """Commands, the digests of the files that they read, and the tables without a history."""

    commands: tuple[str, ...]
    files: tuple[tuple[str, str], ...]
    versions: tuple[str, ...]
    without: tuple[str, ...]


def origins(tables: Sequence[Table]) -> Origins:
    """Tables share most of their history: each command and each file is named once."""
    outputs: dict[str, dict[str, None]] = {}
    for table in tables:
        for pipe, output in _steps(table):
            outputs.setdefault(pipe, {})[output] = None
    entries = [entry for table in tables for entry in table.meta.history]
    inputs = [pair for entry in entries for pair in entry["inputs"].items()]
    lines = [" ".join(filter(None, (pipe, *sorted(words)))) for pipe, words in outputs.items()]
    return Origins(
        commands=tuple(sorted(map(printable, lines), key=_step)),
        files=tuple(sorted({(printable(file), digest) for file, digest in inputs if digest})),
        versions=tuple(dict.fromkeys(entry["version"] for entry in entries)),
        without=tuple(printable(table.name) for table in tables if not table.meta.history),
    )


def _steps(table: Table) -> Iterator[tuple[str, str]]:
    """The pipes of one history, and the words that name the output of each."""
    history, pipe = table.meta.history, ""
    for entry, after in zip(history, (*history[1:], None), strict=True):
        pipe += entry["command"]
        if after and STDIN in after["inputs"]:
            pipe += " | "
            continue
        option = "-o" if after else BESIDE.get(table.meta.kind or "", "-o")
        name = _read_first(after) if after else table.name
        yield pipe, f"{option} {shlex.quote(name)}" if name not in ("", STDIN) else ""
        pipe = ""


def _read_first(entry: Mapping[str, Any]) -> str:
    """The file that a command reads as its table, where its words name it."""
    try:
        words = shlex.split(entry["command"])
    except ValueError:
        return ""
    return next((word for word in words[2:] if word in entry["inputs"]), "")


def _step(line: str) -> int:
    """The place of a pipe by its last command; commands of equal places keep their order."""
    name = line.rpartition("| ")[2].removeprefix("scarid ").partition(" ")[0]
    return STEPS.index(name) if name in STEPS else len(STEPS)
