"""Stages in one process: `scarid filter log.csv then differentiate then identify`.

A stage that writes its table hands it to the next stage, which pulls the batches from it. So the
stages are nested calls: the last one ends first. A single command is a chain of one stage.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import click

from scarid_cli.cli.declaring.options import InputFile
from scarid_cli.cli.running.command_line import inputs, other_inputs, outputs
from scarid_cli.cli.running.terminal import told
from scarid_cli.errors import OK

if TYPE_CHECKING:
    import pyarrow as pa

    from scarid_cli.io.bytesource import ByteSource
    from scarid_cli.io.table import Table

THEN = "then"
# What is reported of the whole command line, and not of one of its stages.
PASSED = (click.ClickException, click.exceptions.Exit, click.Abort, BrokenPipeError)


class StageFailed(Exception):
    """The error of one stage, with the stage's name."""

    def __init__(self, where: str, error: Exception) -> None:
        super().__init__(where)
        self.where, self.error = where, error


@dataclass(frozen=True)
class Place:
    """What a stage has for neighbours: `source` before it, if any, and the one `following`.

    `read` are the files that the stages before it read, and `shown` takes what it would print.
    """

    say: Callable[[str], None]
    source: ByteSource | None = None
    following: Callable[[Table], None] | None = None
    read: tuple[str, ...] = ()
    shown: Callable[[str], object] | None = None


def split(words: Sequence[str]) -> list[list[str]]:
    """The words of each stage."""
    stages: list[list[str]] = [[]]
    for word in words:
        if word == THEN:
            stages.append([])
        else:
            stages[-1].append(word)
    return stages


def run(group: click.Group, words: Sequence[str]) -> int:
    """Run a command line of one or more stages, and return its exit status.

    All stages are parsed before the first one runs. The failure of a stage is StageFailed; wrong
    usage is click's UsageError.
    """
    stages = split(words)
    if len(stages) > 1 and not all(stages):
        raise click.UsageError(f"a command is missing before or after `{THEN}`")
    with group.make_context("scarid", stages[0]) as context:
        contexts = [_parsed(group, context, stage) for stage in stages]
        for before, after in pairwise(contexts):
            _require_output(before)
            _require_input(after)
        _require_different_outputs(contexts)
        return Chain(contexts).run()


def called(group: click.Group, words: Sequence[str], place: Place) -> int:
    """Run one command at this place, and return its exit status; it writes to no terminal."""
    with group.make_context("scarid", list(words)) as context:
        stage = _parsed(group, context, list(words))
        stage.obj = place
        try:
            with _named(stage.command_path), stage:
                stage.command.invoke(stage)
        except click.exceptions.Exit as stop:
            return stop.exit_code
    return OK


def _parsed(group: click.Group, parent: click.Context, words: list[str]) -> click.Context:
    with _named(f"scarid {words[0]}"):
        name, command, rest = group.resolve_command(parent, words)
        assert command is not None
        return command.make_context(name, rest, parent=parent)


def _require_output(context: click.Context) -> None:
    """Refuse a command before `then` whose table, if it has any, goes elsewhere."""
    place = context.params.get("output")
    if "format" not in context.params:
        context.fail(f"writes no table, and can only be the last command of `{THEN}`")
    if place not in ("-", None):
        context.fail(
            f"-o {place}: the table goes to the next command; write it with `{THEN} tee {place}`"
        )


def _require_different_outputs(contexts: Sequence[click.Context]) -> None:
    """Refuse a line of stages that writes a file twice, or one that it reads."""
    if len(contexts) < 2:
        return  # the job of a single command sees to it
    from scarid_cli.io.target import same_place

    read = [file for context in contexts for file in other_inputs(context)]
    written: list[str] = []
    for context in contexts:
        for path in outputs(context):
            if any(same_place(path, other) for other in written):
                context.fail(f"{path}: two outputs cannot share it; give one of them another FILE")
            if any(same_place(path, file) for file in read):
                context.fail(f"{path}: this is the input; give the output another FILE")
            written.append(path)


def _require_input(context: click.Context) -> None:
    """Refuse a command after `then` that does not read what is handed to it."""
    files = [p for p in context.command.params if isinstance(p.type, InputFile) and _is_read(p)]
    values = [context.params[parameter.name or ""] for parameter in files]
    listed = [value if isinstance(value, tuple) else (value,) for value in values]
    if "place" in context.params:
        return  # tee, which has no other input
    if any("-" in several or not several for several in listed):
        return
    if given := [value for several in listed for value in several if value]:
        context.fail(f"reads {given[0]}, not the table before `{THEN}`; leave the file out")
    context.fail(f"reads no table, and can only be the first command of `{THEN}`")


def _is_read(parameter: click.Parameter) -> bool:
    """Whether this is the place for a table, rather than for a robot."""
    assert isinstance(parameter.type, InputFile)
    return "" in parameter.type.endings


class Chain:
    """The run of stages that are parsed.

    What a stage says is held until the stages before it have ended, which come first in the output.
    """

    def __init__(self, contexts: Sequence[click.Context]) -> None:
        self._contexts = contexts
        self._status = OK
        self._held: list[tuple[int, str]] = []

    def run(self) -> int:
        """The exit status: as of a pipe with `pipefail`, that of the last stage that has one."""
        try:
            self._invoke(0, None)
        finally:
            for _, line in sorted(self._held, key=lambda entry: entry[0]):
                _print(line)
        return self._status

    def _invoke(self, index: int, source: ByteSource | None) -> None:
        context = self._contexts[index]
        last = index == len(self._contexts) - 1
        context.obj = Place(
            lambda text: self._say(index, f"{context.command_path}: {text}"),
            source,
            None if last else lambda table: self._hand(index, table),
            tuple(word for before in self._contexts[:index] for word in inputs(before)),
        )
        try:
            with _named(context.command_path), context:
                context.command.invoke(context)
        except click.exceptions.Exit as stop:
            self._status = self._status or stop.exit_code

    def _hand(self, index: int, table: Table) -> None:
        """Run the next stage on the table of this one."""
        from scarid_cli.io.arrowio import Handed

        batches = _guarded(table.batches, self._contexts[index].command_path)
        self._invoke(index + 1, Handed(replace(table, batches=batches)))

    def _say(self, index: int, line: str) -> None:
        if index:
            self._held.append((index, line))
        else:
            _print(line)


@contextlib.contextmanager
def _named(where: str) -> Iterator[None]:
    """Give an error the name of the stage whose code it comes from."""
    try:
        yield
    except (*PASSED, StageFailed):
        raise
    except Exception as error:
        raise StageFailed(where, error) from error


def _guarded(batches: Iterator[pa.RecordBatch], where: str) -> Iterator[pa.RecordBatch]:
    with _named(where):
        yield from batches


def _print(line: str) -> None:
    with contextlib.suppress(OSError):  # a remark that cannot be made is no failure
        print(told(line), file=sys.stderr)  # noqa: T201
