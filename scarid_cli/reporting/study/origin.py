"""How the tables of a report were made: each command once, in an order in which it can be run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from scarid_cli.io.table import Table


@dataclass(frozen=True)
class Origin:
    """All commands once; the digests of their inputs; and for each table the commands' numbers.

    `inputs` are pairs of a file and its SHA-256 digest, or what stands for one.
    """

    commands: tuple[str, ...]
    versions: tuple[str, ...]
    inputs: tuple[tuple[str, str], ...]
    tables: tuple[tuple[str, str], ...]


def origin(tables: Sequence[Table]) -> Origin:
    """What the histories of the tables say, without repetitions."""
    entries = [entry for table in tables for entry in table.meta.history]
    commands = list(dict.fromkeys(entry["command"] for entry in entries))
    inputs = {
        (file, digest or "read from a pipe")
        for entry in entries
        for file, digest in entry["inputs"].items()
    }
    return Origin(
        commands=tuple(commands),
        versions=tuple(sorted({entry["version"] for entry in entries})),
        inputs=tuple(sorted(inputs)),
        tables=tuple((table.name, _numbers(table, commands)) for table in tables),
    )


def _numbers(table: Table, commands: Sequence[str]) -> str:
    numbers = [str(commands.index(entry["command"]) + 1) for entry in table.meta.history]
    return ", ".join(numbers) or "no history is recorded; a CSV file cannot carry one"
