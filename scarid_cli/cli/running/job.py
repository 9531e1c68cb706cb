"""One run of a command: its inputs and outputs, its reports to the user, and the history."""

from __future__ import annotations

import contextlib
import json
import os
import stat
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import click

from scarid_cli import __version__
from scarid_cli.algorithms.choices.settings import LONGEST
from scarid_cli.cli.declaring.selecting import selection_of
from scarid_cli.cli.running.chain import Place
from scarid_cli.cli.running.command_line import command_line, given_words, inputs
from scarid_cli.cli.running.remarks import Remarks
from scarid_cli.cli.running.remedies import remedies, require_our_names
from scarid_cli.cli.running.robots import another, misfit, require_as_many, require_torques
from scarid_cli.cli.running.terminal import is_terminal
from scarid_cli.errors import ForeignLog, TooShort, UsageFault
from scarid_cli.io import schemas
from scarid_cli.io.bytesource import STDIN, ByteSource
from scarid_cli.io.reader import Reads, checked, conforming, open_table, require
from scarid_cli.io.selection import FILL, REFUSE, SPLIT, Lacking, Whole, within
from scarid_cli.io.stated import in_file, stated_robot
from scarid_cli.io.stop import STOP
from scarid_cli.io.table import Table
from scarid_cli.io.target import same_place
from scarid_cli.io.writer import Document, Handover, InFolder, Output, all_or_none
from scarid_cli.printable import printable

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot

D = TypeVar("D", Output, Document)


class Job:
    """Made by `job()`, which commits its outputs together, or none of them.

    `out` is where the command's table goes; `left_out` collects why segments of a record were
    too short for a method, and `notes` what is to be reported with the result.
    """

    out: Output

    def __init__(self, options: dict[str, Any]) -> None:
        context = click.get_current_context()
        place = context.obj
        self.place: Place = place
        self._inputs = [*place.read, *inputs(context)]
        self.quiet: bool = options["quiet"]
        self._verbose = options["verbose"] and not self.quiet
        self._history = not options.get("no_history")
        self.outputs: list[Output | Document] = []
        self.sources: list[ByteSource] = []
        self.left_out: list[TooShort] = []
        self.notes: list[str] = []
        self.converted_by: str | None = None  # the robot whose [log] names the columns of a log
        self.watched = ""  # what a person sees beside the number of rows
        self.remarks = Remarks(place.say)
        self._selection = selection_of(options)
        self._lacking: list[tuple[str, Whole]] = []
        self._begun: dict[str, Table] = {}

    def output(self, path: str, wanted: str | None = None, *, readable: bool = False) -> Output:
        """The output for a table; opened before anything is read, so that mistakes show at once.

        On a terminal, a table that is `readable` is printed for a person.
        """
        if path == "-" and self.place.following:
            following = self.place.following
            return self._new(path, lambda: Handover(following))
        asked = wanted or os.environ.get("SCARID_FORMAT")
        if readable and path == "-" and not asked and is_terminal():
            from scarid_cli.cli.running.readable import Readable

            return self._new(path, lambda: Readable(path))
        return self._new(path, lambda: Output(path, wanted))

    @property
    def writes_csv(self) -> bool:
        """Whether the command's table is written as CSV, which has no metadata."""
        return hasattr(self, "out") and self.out.format == "csv"

    def text(self, path: str) -> Document:
        """The output for a document beside the tables, which is opened early as well."""
        return self._new(path, lambda: Document(path))

    def figure(self, path: str) -> Document:
        """The output for a document in a folder that is made if need be."""
        return self._new(path, lambda: InFolder(path))

    def side_table(self, path: str | None) -> Output | None:
        """The table of a side output, if it was asked for."""
        return self.output(path) if path else None

    def side_text(self, path: str | None) -> Document | None:
        """The document of a side output, if it was asked for."""
        return self.text(path) if path else None

    def _new(self, path: str, opened: Callable[[], D]) -> D:
        if any(same_place(path, output.path) for output in self.outputs):
            place = "standard output" if path == "-" else path
            raise UsageFault(f"{place}: two outputs cannot share it; give one of them another FILE")
        if path != "-" and any(same_place(path, x) for x in self._inputs if x != "-"):
            raise UsageFault(f"{path}: this is the input; give the output another FILE")
        with STOP.postponed():
            self.outputs.append(output := opened())
        return output

    def read(
        self,
        path: str,
        kind: str | None,
        *,
        reads: Reads | None = None,
        regular: bool = True,
        robot: str | None = None,
    ) -> Table:
        """Open a table and check that it is of this kind; without a kind, take any table.

        A log by other names is converted as the description of its `robot` says. `reads` names the
        columns whose values must be there (see io.reader.checked). The clock must be regular unless
        `regular` is false.
        """
        table = self._opened_table(path)
        if not kind:
            return self._reported(table)
        if schemas.load(kind).sampled:
            table = self.as_named(table, robot)
            require_our_names(path, table)
            table = self.within(table)
        return self._checked(path, table, kind, reads, regular=regular)

    def _checked(
        self, path: str, table: Table, kind: str, reads: Reads | None, *, regular: bool
    ) -> Table:
        """The table, whose rows with missing values are treated as --missing says."""
        lacking = None
        if self._selection.missing != REFUSE and schemas.load(kind).sampled:
            lacking = partial(self._without_lacking, table.name)
        found = remedies(path, regular=regular)
        return self._reported(
            checked(table, kind, reads=reads, regular=regular, lacking=lacking, remedies=found)
        )

    def _without_lacking(self, name: str, columns: list[str]) -> Whole:
        lacking: Whole = Lacking(columns, self._selection.missing == SPLIT)
        if self._selection.missing == FILL:
            from scarid_cli.stages.records.filled import Filled  # not needed otherwise

            lacking = Filled(columns)
        self._lacking.append((name, lacking))
        return lacking

    def doubt_rate(self, period: float) -> None:
        """Warn of rows so far apart [s] that their time is hardly in seconds."""
        if period > LONGEST:
            from scarid_cli.stages.remarks.glance import of_rate

            if finding := of_rate(period):
                self.say(f"warning: {finding.text}")

    def read_for(
        self,
        path: str,
        kind: str,
        robot: str | Robot | None,
        *,
        torques: bool = False,
        reference: bool = False,
        without_derivatives: str | None = None,
        as_recorded: bool = False,
    ) -> tuple[Table, Robot]:
        """Open a table that has every column of this kind for each of the robot's joints.

        The command also reads its `torques`, which must be there, or the `reference`, if it is. If
        the command can do `without_derivatives`, this is the kind of a table that has none. Values
        and clock of a table `as_recorded` are not checked.
        """
        opened = self._as_described(self._opened_table(path), robot)
        if without_derivatives and not schemas.numbered(opened.columns, "ddq"):
            kind = without_derivatives
        require_our_names(path, opened)
        table = conforming(self.within(opened), kind)
        arm = self.robot(robot, table) if isinstance(robot, str | None) else robot
        if torques:
            require_torques(table)
        fields = [f.name for f in schemas.load(kind).fields if f.required and f.per_joint]
        fields += ["tau{i}"] if torques else []
        columns = schemas.of_joints(len(arm.joints), *fields)
        require(table, columns, f"this column for robot {arm.name} (another: --robot)")
        if remark := misfit(table, arm, columns):
            self.notes.append(remark)
        if as_recorded:
            return self._reported(table), arm
        if reference:
            columns += [name for name in table.columns if name.endswith("_ref")]
        return self._checked(path, table, kind, lambda _: columns, regular=True), arm

    def _as_described(self, table: Table, robot: str | Robot | None) -> Table:
        """A log of motors or by other names, converted as [log] of the robot's TOML file says."""
        arm = self._with_log(robot)
        if not (arm and arm.log):
            return table
        if arm.log.is_of(table.columns):
            return self._converted(table, arm)
        if not arm.log.columns and arm.log.converts and not table.meta.history:
            self.notes.append(
                f"{table.name}: taken as positions and torques of the joints, as `scarid convert "
                f"--robot {arm.name}` writes them; if it has other zeros, or is of the motors, "
                "convert it first"
            )
        return table

    def _with_log(self, robot: str | Robot | None) -> Robot | None:
        """The robot, or the one of SCARID_ROBOT, if it has a [log]."""
        name = robot or os.environ.get("SCARID_ROBOT") or ""
        if isinstance(name, str) and not name.endswith(".toml"):
            return None
        from scarid_cli.algorithms.robots.reading import load

        arm = load(name) if isinstance(name, str) else name
        return arm if arm.log else None

    def as_named(self, table: Table, robot: str | None) -> Table:
        """A log by the names that [log] of the robot's TOML file states, by ours.

        The file is only read if the log has none of ours, as its reader takes a while.
        """
        if schemas.named(table.columns):
            return table
        arm = self._with_log(robot)
        if not (arm and arm.log and arm.log.is_of(table.columns)):
            return table
        return self._converted(table, arm)

    def _converted(self, table: Table, arm: Robot) -> Table:
        """A log of this robot, as its [log] says."""
        from scarid_cli.stages.conversion.joints import as_described

        self.notes.append(f"{table.name}: columns, units and motors by [log] of {arm.name}")
        self.converted_by = arm.name
        return as_described(table, arm, {}, [], None)

    def robot(self, name: str | None, *tables: Table) -> Robot:
        """The robot of this name, else as the first table states, else as SCARID_ROBOT does.

        Reports which one is assumed if none is stated, and a table that states another one. None
        is assumed for a table with another number of joints.
        """
        from scarid_cli.algorithms.robots.reading import DEFAULT_ROBOT, load

        found = name or next(filter(None, map(stated_robot, tables)), None)
        found = found or os.environ.get("SCARID_ROBOT")
        if not found:
            require_as_many(load(DEFAULT_ROBOT), tables)
            self.notes.append(
                f"no robot is stated, {DEFAULT_ROBOT} is assumed (state it with --robot or "
                "SCARID_ROBOT)"
            )
        robot = load(self.described(found or DEFAULT_ROBOT))
        doubts = robot.body.doubts if robot.body else []
        self.notes += [f"warning: {robot.name}, {doubt}" for doubt in doubts]
        if remark := another(robot, tables):
            self.notes.append(remark)
        return robot

    def columns_of(self, path: str) -> list[str]:
        """The columns of a table, which is read afterwards."""
        self._begun[path] = self._opened_table(path)
        return self._begun[path].columns

    def _opened_table(
        self, path: str, through: Callable[[ByteSource], ByteSource] | None = None
    ) -> Table:
        if path in self._begun:
            return self._begun.pop(path)
        return self._followed(self.opened(path), through)

    def _followed(
        self, source: ByteSource, through: Callable[[ByteSource], ByteSource] | None = None
    ) -> Table:
        """The table in a source, with a progress line where a person waits: not inside a pipe."""
        try:
            table = open_table(through(source) if through else source)
        except ForeignLog as log:  # whose joints are in the order of the robot
            raise ForeignLog(log.name, log.what, given_words(["robot"])) from None
        hands_over = self.place.following is not None
        if self.quiet or hands_over or not is_terminal(2) or stat.S_ISFIFO(os.fstat(1).st_mode):
            return table
        from scarid_cli.cli.running.progress import counted

        found = counted(table.batches, table.length, source.part_read, lambda: self.watched)
        return replace(table, batches=found)

    def read_source(self, source: ByteSource) -> Table:
        """A table of any kind from bytes that are open already."""
        return self._reported(self._followed(source))

    def within(self, table: Table) -> Table:
        """The rows of a log that --from-time, --to-time and --rows choose."""
        return within(table, self._selection)

    def _reported(self, table: Table) -> Table:
        """The table, reported with --verbose."""
        if self._verbose:
            rate = f"{1.0 / table.period:.6g} Hz, " if table.period else ""
            text = f"{table.name}: {table.meta.kind}, {rate}columns {', '.join(table.columns)}"
            self.place.say(printable(text))
        return table

    def described(self, robot: str) -> str:
        """The robot; the history names the file of its description, if it is in one."""
        known = (source.name for source in self.sources)
        return self.noted(robot) if in_file(robot) and robot not in known else robot

    def noted(self, path: str) -> str:
        """The path of an input that is not a table; the history names it as well."""
        self.opened(path)
        return path

    def opened(self, path: str) -> ByteSource:
        """The bytes of an input, which the history names."""
        if path == "-" and STDIN in {source.name for source in self.sources}:
            raise UsageFault(
                "standard input can be read only once; give a FILE for the other table"
            )
        source = (path == "-" and self.place.source) or ByteSource.open(path)
        self.sources.append(source)
        return source

    def write_or_print(self, table: Table, document: Callable[[Table], Any] | None) -> None:
        """Send a small table to the command's output; print its JSON `document`, if there is one.

        The document takes the place of the table, unless that goes to a file.
        """
        if not document:
            self.write(table)
            return
        if self.place.following:
            raise UsageFault("--json prints a document, and can only be the last command of `then`")
        batches = list(table.batches)
        if hasattr(self, "out"):
            self.out.take(replace(table, batches=iter(batches)))
        self._tell_of_reading()
        text = json.dumps(document(replace(table, batches=iter(batches))), allow_nan=False)
        self.show(text)

    def show(self, text: str, end: str = "\n") -> None:
        """Print on standard output, or hand the text to who called the command."""
        if self.place.shown:
            self.place.shown(f"{text}{end}")
        else:
            click.echo(f"{text}{end}", nl=False)

    def write(self, table: Table, output: Output | None = None) -> None:
        """Send a table to an output, by default the command's, and report omitted segments."""
        (output or self.out).take(table)
        self._tell_of_reading()

    def _tell_of_reading(self) -> None:
        """Report what was noted on the inputs, and what was left out of them."""
        self.say_notes()
        if self.left_out:
            count = len(self.left_out)
            self.say(f"{count} segment{'s' if count > 1 else ''} left out: {self.left_out[0]}")
        self._say_lacking()

    def _say_lacking(self) -> None:
        """Report the rows that --missing left out."""
        for name, lacking in self._lacking:
            if lacking.count:
                self.say(f"{name}: {lacking.text}")
        self._lacking.clear()

    def recorded(self, table: Table) -> Table:
        """The table with this command, and the digests of its inputs so far, in its history."""
        if not self._history:
            return replace(table, meta=replace(table.meta, history=()))
        inputs = {source.name: source.sha256() for source in self.sources}
        entry = {"command": command_line(), "version": __version__, "inputs": inputs}
        return replace(table, meta=replace(table.meta, history=(*table.meta.history, entry)))

    def say_notes(self) -> None:
        """Report what was noted on the inputs."""
        while self.notes:
            self.say(self.notes.pop(0))

    def say_if_interpreted(self) -> None:
        """Report that the run will be slow, at its start, once in a line of stages."""
        from scarid_cli.cli.declaring.interpreted import notice

        if not self.quiet and self.place.source is None and (text := notice()):
            self.place.say(text)

    def demand(self, message: str) -> None:
        """Report that the result is not what --require asks for, even if the run is quiet."""
        self.remarks.keep(message, "", "")

    def say(self, message: str, verdict: str = "", command: str = "") -> None:
        """Report a line to the user, on standard error, once the run has ended well.

        On a terminal it begins in the colour of the `verdict`, if it begins with one. A `command`
        line to copy ends it.
        """
        if not self.quiet:
            self.remarks.keep(message, verdict, command)


@contextlib.contextmanager
def job(options: dict[str, Any]) -> Iterator[Job]:
    """A run of a command, given the options of `common` and `table_output`."""
    run = Job(options)
    try:
        with all_or_none(run.outputs):
            yield run
            run.say_notes()
            if STOP.told and run.place.source is None:
                run.say(STOP.told)
        run.remarks.tell()
    finally:
        for source in run.sources:
            source.close()


def per_joint(values: Sequence[float], joints: int, option: str) -> list[float]:
    """One number per joint, from one per joint or from one for all of them."""
    if len(values) not in (1, joints):
        raise UsageFault(f"{option}: {len(values)} values for {joints} joints; give 1 or {joints}")
    return list(values) * (joints // len(values))
