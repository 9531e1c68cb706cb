"""One run of a command: its inputs, its outputs, what it tells the user and the history."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from scarid_cli import __version__
from scarid_cli.errors import TooShort, UsageFault
from scarid_cli.io import schemas
from scarid_cli.io.bytesource import STDIN, ByteSource
from scarid_cli.io.reader import checked, open_table, require
from scarid_cli.io.table import Table
from scarid_cli.io.writer import Document, Output, all_or_none, write_table

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot

# Options that do not change what the table holds.
SILENT = {
    "output",
    "save",
    "trace",
    "predictions",
    "base",
    "format",
    "no_history",
    "quiet",
    "verbose",
    "debug",
}


class Job:
    """Made by `job()`, which closes its outputs together, or none of them."""

    def __init__(self, *, quiet: bool, verbose: bool, history: bool) -> None:
        self._quiet = quiet
        self._verbose = verbose and not quiet
        self._history = history
        self._inputs: dict[str, str | None] = {}
        self.outputs: list[Output | Document] = []
        self.sources: list[ByteSource] = []
        self.left_out: list[TooShort] = []  # segments of a record

    def output(self, path: str, wanted: str | None = None) -> Output:
        """Where a table will go; opened before anything is read."""
        if path in {output.path for output in self.outputs}:
            raise UsageFault(
                f"{'standard output' if path == '-' else path}: two tables cannot share it"
            )
        output = Output(path, wanted)
        self.outputs.append(output)
        return output

    def text(self, path: str) -> Document:
        """Where a document beside the tables will go."""
        if path in {output.path for output in self.outputs}:
            raise UsageFault(f"{path}: a table and a document cannot share it")
        document = Document(path)
        self.outputs.append(document)
        return document

    def read(
        self,
        path: str,
        kind: str | None,
        *,
        regular: bool = True,
        through: Callable[[ByteSource], ByteSource] | None = None,
    ) -> Table:
        """A checked table of a kind, or any table as it stands for None.

        `regular`: its clock must be; `through` may translate its bytes.
        """
        if path == "-" and STDIN in self._inputs:
            raise UsageFault(
                "standard input can be read only once; give a FILE for the other table"
            )
        source = self._opened(path)
        table = open_table(through(source) if through else source)
        if kind:
            table = checked(table, kind, regular=regular)
        if self._verbose:
            rate = f"{1.0 / table.meta.period:.6g} Hz, " if table.meta.period else ""
            self.say(f"{source.name}: {table.meta.kind}, {rate}columns {', '.join(table.columns)}")
        return _counted(table, self._quiet)

    def noted(self, path: str) -> str:
        """The path of an input that is no table, for the history."""
        self._opened(path)
        return path

    def _opened(self, path: str) -> ByteSource:
        source = ByteSource.open(path)
        self.sources.append(source)
        self._inputs[source.name] = source.sha256() if self._history else None
        return source

    def read_for(
        self, path: str, kind: str, robot: str | None, *, torques: bool = False
    ) -> tuple[Table, Robot]:
        """A checked table with every column that the robot's joints need of this kind."""
        table = self.read(path, kind)
        arm = robot_of(robot, table)
        joints = range(1, len(arm.joints) + 1)
        fields = [f.name for f in schemas.load(kind).fields if f.required and f.per_joint]
        fields += ["tau{i}"] if torques else []
        columns = [name.replace("{i}", str(i)) for name in fields for i in joints]
        require(table, columns, f"this one for robot {arm.name} (another: --robot)")
        return table, arm

    def write(self, table: Table, output: Output) -> None:
        """Send a table out, and tell which segments of it were left out."""
        write_table(table, output)
        if self.left_out:
            count = len(self.left_out)
            self.say(f"{count} segment{'s' if count > 1 else ''} left out: {self.left_out[0]}")

    def recorded(self, table: Table) -> Table:
        """The table with this command at the end of its history."""
        if not self._history:
            return replace(table, meta=replace(table.meta, history=()))
        entry = {"command": command_line(), "version": __version__, "inputs": self._inputs}
        return replace(table, meta=replace(table.meta, history=(*table.meta.history, entry)))

    def say(self, message: str) -> None:
        """Tell the user something on standard error."""
        if not self._quiet:
            name = click.get_current_context().command_path
            print(f"{name}: {message}", file=sys.stderr)  # noqa: T201


@contextlib.contextmanager
def job(options: dict[str, Any]) -> Iterator[Job]:
    """A run with the options of `common` and `table_output`."""
    run = Job(
        quiet=options["quiet"],
        verbose=options["verbose"],
        history=not options.get("no_history"),
    )
    try:
        with all_or_none(run.outputs):
            yield run
    finally:
        for source in run.sources:
            source.close()


def robot_of(name: str | None, *tables: Table) -> Robot:
    """The robot asked for, else that of the first table that names one, else the paper's."""
    from scarid_cli.algorithms.robots import reading

    stated = (table.meta.robot for table in tables if table.meta.robot)
    return reading.load(name or next(stated, reading.DEFAULT))


def per_joint(values: Sequence[float], joints: int, option: str) -> list[float]:
    """One number per joint: given so, or one for all."""
    if len(values) not in (1, joints):
        raise UsageFault(f"{option}: {len(values)} values for {joints} joints; give 1 or {joints}")
    return list(values) * (joints // len(values))


def command_line() -> str:
    """The command with the options that were given and change the result, in a fixed order."""
    context = click.get_current_context()
    words = [context.info_name or ""]
    for parameter in context.command.params:
        name = parameter.name or ""
        source = context.get_parameter_source(name)
        if name in SILENT or source is None or source.name != "COMMANDLINE":
            continue
        words += _words(parameter, context.params[name])
    return " ".join(["scarid", *words])


def _words(parameter: click.Parameter, value: Any) -> list[str]:
    import shlex

    if isinstance(parameter, click.Argument):
        values = value if isinstance(value, tuple) else (value,)
        return [shlex.quote(str(v)) for v in values]
    option = max(parameter.opts, key=len)
    if parameter.is_flag:  # type: ignore[attr-defined]
        return [option if value else parameter.secondary_opts[0]]
    return [
        word
        for item in (value if parameter.multiple else [value])
        for word in (option, *map(shlex.quote, _texts(item, parameter.nargs)))
    ]


def _texts(value: Any, count: int) -> list[str]:
    if not isinstance(value, tuple):
        return [str(value)]
    texts = [f"{v:g}" if isinstance(v, float) else str(v) for v in value]
    return texts if count > 1 else [",".join(texts)]


def _counted(table: Table, quiet: bool) -> Table:
    """The table, with a progress line where a person waits: not in the middle of a pipe."""
    import stat
    from os import fstat

    if quiet or not sys.stderr.isatty() or stat.S_ISFIFO(fstat(1).st_mode):
        return table
    from scarid_cli.cli.progress import counted

    return replace(table, batches=counted(table.batches))
