"""What to type where a log has other names, no constant rate, or lacks values: the whole pipe."""

from __future__ import annotations

import shlex
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import click

from scarid_cli.cli.declaring.options import SELECTION
from scarid_cli.cli.running.command_line import command_line, given_words
from scarid_cli.errors import CORRECT, bad_data

if TYPE_CHECKING:
    import pyarrow as pa

    from scarid_cli.io.remedies import Remedies
    from scarid_cli.io.table import Table

DROP, FILL = "--missing drop", "--missing fill"
WINDOW = [name for name in SELECTION if name != "missing"]


@dataclass(frozen=True)
class Pipe:
    """A command that a table passes before this one reads it; `words` follow its own."""

    before: str
    words: Sequence[str]
    after: str

    def through(self, command: str) -> str:
        """The pipe, given the command and its first words."""
        return f"{self.before}{' '.join([command, *self.words])}{self.after}"


def remedies(path: str, *, regular: bool) -> Remedies:
    """The remedies for the table at this path, whose clock has to be `regular` or need not be.

    The words are those of the command line now: when a fault is found, a later stage may run.
    """
    from scarid_cli.io.remedies import Remedies  # pyarrow, which `--help` does not need

    if not regular:
        return Remedies(value=lambda _: f"{CORRECT}, or leave such rows out with {DROP}")
    constant = partial(
        _text, "put it on a constant rate with", _pipe(path, given_words(["missing"]), SELECTION)
    )
    if "missing" not in click.get_current_context().params:
        return Remedies(clock=constant)
    pipes = [_pipe(path, [word], SELECTION) for word in (DROP, FILL)]
    return Remedies(value=partial(_whole, *pipes), clock=constant)


def _text(start: str, pipe: Pipe, rows: pa.RecordBatch) -> str:
    if "t" not in rows.schema.names:  # a table of parameters has no rate
        return CORRECT
    from scarid_cli.stages.records.rates import advised_rate

    return f"{start} `{pipe.through(f'scarid resample --rate {advised_rate(rows)}')}`"


def _whole(drop: Pipe, fill: Pipe, rows: pa.RecordBatch) -> str:
    """What to do about a row that lacks a value, as it is followed by these."""
    from scarid_cli.stages.records.filled import of_one_source

    own = of_one_source(rows)
    if own is None:
        return _text(f"{CORRECT}, or leave it out with", drop, rows)
    return _text("each row has the values of one source: interpolate them with", fill, own)


def require_our_names(path: str, table: Table) -> None:
    """Refuse a log to which `scarid convert` can give the names of our columns."""
    from scarid_cli.io.schemas import COUNTED_FROM_0, named

    if named(table.columns):
        return
    from scarid_cli.stages.conversion.wording import renamable  # which few logs need

    if not (renamable(table.columns) or _described(table.columns)):
        return
    pipe = _pipe(path, given_words(["robot"]), WINDOW)
    counted = COUNTED_FROM_0 in table.columns
    raise bad_data(
        table.name,
        f"the columns {', '.join(table.columns)}",
        expected="joints counted from 1" if counted else "t, q1, ..., tau1, ...",
        remedy=f"rename them with `{pipe.through('scarid convert')}`",
        column=COUNTED_FROM_0 if counted else "q1" if "t" in table.columns else "t",
    )


def _described(columns: Collection[str]) -> bool:
    """Whether the description of the robot that was given names some of these columns."""
    robot = click.get_current_context().params.get("robot")
    if not robot:
        return False
    from scarid_cli.algorithms.robots.reading import load  # a log with our names needs no robot

    log = load(robot).log
    return log is not None and not set(log.columns.values()).isdisjoint(columns)


def _pipe(path: str, words: list[str], moved: Collection[str]) -> Pipe:
    """The pipe for one of the command's logs, or for a table that it reads beside them.

    The first command has these words, and those options of this one that are `moved` to it.
    """
    name = [] if path == "-" else [shlex.quote(path)]
    parameters = click.get_current_context().params
    files = list(parameters.get("files", [parameters.get("file")])) or ["-"]
    if path not in files:
        return Pipe("", [*words, *name], "")
    if len(files) == 1:
        words = [*given_words(WINDOW), *words, "--format arrow", *name]
        return Pipe("", words, f" | {command_line(without=('file', 'files', *moved))}")
    at = files.index(path)
    before = [command_line(without=("files",)), *map(shlex.quote, files[:at]), "<("]
    after = "".join(f" {shlex.quote(file)}" for file in files[at + 1 :])
    return Pipe(" ".join(before), [*words, "--format arrow", *name], f"){after}")
