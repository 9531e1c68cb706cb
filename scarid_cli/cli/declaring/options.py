"""Options that several commands take, declared once, and the types of options."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite
from typing import Any, TypeVar

import click

from scarid_cli.cli.declaring.headings import METHOD, OUTPUT, heading
from scarid_cli.errors import OutputFailure, UsageFault
from scarid_cli.io import FORMATS

F = TypeVar("F", bound=Callable[..., Any])


# The options of `selecting`, `table_output` and `common`: the job deals with them, not the command.
SELECTION = ("from_time", "to_time", "rows", "missing")
SHARED = (*SELECTION, "output", "format", "no_history", "quiet", "verbose", "debug")


def offered(what: str) -> Callable[[click.Context, click.Parameter, str], list[Any]]:
    """What the shell offers at the Tab key: a function of `completing`, imported only there."""

    def offer(ctx: click.Context, parameter: click.Parameter, incomplete: str) -> list[Any]:
        from scarid_cli.cli.declaring import completing

        items: list[Any] = getattr(completing, what)(ctx, parameter, incomplete)
        return items

    return offer


class Unrecorded(click.Option):
    """An option that changes nothing in the table: the history leaves it out."""


class OutputFile(Unrecorded):
    """An option that names a file, or a folder, to write."""

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[Any]:
        """Files."""
        from scarid_cli.cli.declaring import completing

        return completing.file(ctx, self, incomplete)


class InputFile(click.ParamType[str]):
    """A file to read, or - for standard input, or one of a few other words.

    With `endings`, a text without any of them is a name and no file. That the file is there is
    checked before anything is read. It is not opened yet: a named pipe can be opened only once.
    With `folders`, the folder of a rosbag2 will do as well; with `roles`, ROLE=FILE.
    """

    name = "file"

    def __init__(
        self,
        *words: str,
        endings: tuple[str, ...] = ("",),
        folders: bool = False,
        roles: tuple[str, ...] = (),
    ) -> None:
        self.words, self.endings = ("-", *words), endings
        self.folders, self.roles = folders, roles

    def convert(self, value: Any, param: Any, ctx: Any) -> str:  # noqa: ARG002
        path = self.file(str(value))
        if path.endswith(self.endings) and path not in self.words:
            require_readable(path, folders=self.folders)
        return str(value)

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[Any]:
        """Files, and the words and robots that may stand for one."""
        from scarid_cli.cli.declaring import completing

        words = [*self.words[1:], *(completing.robots() if ".toml" in self.endings else ())]
        return completing.file(ctx, param, incomplete) + completing.matching(words, incomplete)

    def file(self, value: str) -> str:
        """The file of a value, without its role."""
        role, _, file = value.partition("=")
        return file if file and role in self.roles else value


@dataclass(frozen=True)
class Range:
    """The numbers that an option takes: finite, and from `low` (or above it, if open) to `high`."""

    low: float = -inf
    high: float = inf
    open: bool = False

    def text(self) -> str:
        """What is asked for, in words."""
        if self.low == -inf:
            return "a finite number"
        start = f"above {self.low:g}" if self.open else f"of at least {self.low:g}"
        end = "" if self.high == inf else f", at most {self.high:g}"
        return f"a finite number {start}{end}"

    def __contains__(self, value: float) -> bool:
        above = value > self.low if self.open else value >= self.low
        return isfinite(value) and above and value <= self.high


FINITE = Range()
POSITIVE = Range(0.0, open=True)


class Number(click.ParamType[float]):
    """One number within a range; nan and inf are in none."""

    name = "float"

    def __init__(self, within: Range) -> None:
        self.within = within

    def convert(self, value: Any, param: Any, ctx: Any) -> float:
        try:
            number = float(value)
        except ValueError:
            self.fail(f"{value!r} is not a number", param, ctx)
        if number not in self.within:
            self.fail(f"give {self.within.text()}, not {number:g}", param, ctx)
        return number


class Numbers(click.ParamType[tuple[float, ...]]):
    """One number for all joints, or one per joint separated by commas, all within a range."""

    name = "number[,number...]"

    def __init__(self, within: Range = FINITE) -> None:
        self.within = within

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[float, ...]:
        if isinstance(value, tuple):
            return value
        try:
            numbers = tuple(float(part) for part in value.split(","))
        except ValueError:
            self.fail(f"{value!r} is not a number, or numbers separated by commas", param, ctx)
        for number in numbers:
            if number not in self.within:
                self.fail(f"give {self.within.text()}, not {number:g}", param, ctx)
        return numbers


def require_readable(path: str, *, folders: bool = False) -> None:
    """Refuse a path that does not exist (exit status 2), or that cannot be read (74)."""
    try:
        mode = os.stat(path).st_mode  # noqa: PTH116 (pathlib takes a while to import)
    except FileNotFoundError:
        raise UsageFault(f"{path}: no such file") from None
    except OSError as error:
        raise OutputFailure(f"{path}: {error.strerror}") from None
    if stat.S_ISDIR(mode) and not (folders and _is_recording(path)):
        raise OutputFailure(f"{path}: Is a directory")
    if not os.access(path, os.R_OK):
        raise OutputFailure(f"{path}: Permission denied")


def _is_recording(folder: str) -> bool:
    """Whether a folder is that of a rosbag2, even if its metadata.yaml is lost."""
    ends = (".db3", ".mcap")
    return any(name == "metadata.yaml" or name.endswith(ends) for name in os.listdir(folder))  # noqa: PTH208 (likewise)


INPUT = InputFile()
ROBOT = InputFile(endings=(".toml", ".urdf"))  # or the name of a robot
NUMBERS = Numbers()
NUMBER = Number(POSITIVE)
# Beyond these a command would run for hours, or need more memory than there is.
RATE = Number(Range(1e-9, 1e7, open=True))  # Hz
DURATION = Number(Range(0.0, 1e6, open=True))  # s


def all_of(*decorators: Callable[[F], F]) -> Callable[[F], F]:
    """Several declarations as one, in this order."""

    def decorate(function: F) -> F:
        for decorator in reversed(decorators):
            function = decorator(function)
        return function

    return decorate


def table_input(function: F) -> F:
    """The table to read: FILE, or standard input."""
    return click.argument("file", default="-", metavar="[FILE]", type=INPUT)(function)


def table_inputs(function: F) -> F:
    """The tables to read: FILEs, or standard input."""
    return click.argument("files", nargs=-1, metavar="[FILE]...", type=INPUT)(function)


def log_input(function: F) -> F:
    """The table or the recording to read: FILE, the folder of a rosbag2, or standard input."""
    kind = InputFile(folders=True)
    return click.argument("file", default="-", metavar="[FILE]", type=kind)(function)


def side_output(*names: str, help: str, metavar: str = "FILE") -> Callable[[F], F]:
    """A file to write beside the table, which the table does not depend on."""
    return click.option(*names, cls=OutputFile, metavar=metavar, help=help)


def input_file(
    *names: str, help: str, metavar: str = "FILE", required: bool = False, multiple: bool = False
) -> Callable[[F], F]:
    """A file to read beside the table; - stands for standard input."""
    return click.option(
        *names, type=INPUT, metavar=metavar, required=required, multiple=multiple, help=help
    )


def settings_of(algorithm: str) -> Callable[[F], F]:
    """The settings of an algorithm that is the same for all joints."""
    text = f"A setting of the {algorithm}; repeatable."
    return click.option(
        "--set", "settings", multiple=True, metavar="NAME=VALUE", help=text,
        shell_complete=offered("settings"),
    )  # fmt: skip


table_format: Callable[[F], F] = click.option(
    "--format", cls=Unrecorded, type=click.Choice(FORMATS),
    help="Format of the output.  [default: that of the extension, else $SCARID_FORMAT, else csv]",
)  # fmt: skip


def table_output(function: F) -> F:
    """Where the table goes and in what format."""
    return all_of(
        heading(OUTPUT),
        click.option(
            "-o", "--output", cls=OutputFile, default="-", metavar="FILE",
            help="Write the table to FILE, in the format of its extension "
            "(.csv, .parquet, .arrow for a file, .arrows for a stream).  "
            "[default: standard output]",
        ),
        table_format,
        click.option(
            "--no-history", cls=Unrecorded, is_flag=True,
            help="Write no history into the metadata.",
        ),
    )(function)  # fmt: skip


def as_json(function: F) -> F:
    """Print a JSON document in place of text."""
    option = click.option(
        "--json",
        "as_json",
        cls=Unrecorded,
        is_flag=True,
        help="Print a JSON document, in place of the text or table on standard output.",
    )
    return all_of(heading(OUTPUT), option)(function)


def common(function: F) -> F:
    """What every command takes."""
    return all_of(
        heading(OUTPUT),
        click.option(
            "-q",
            "--quiet",
            cls=Unrecorded,
            is_flag=True,
            help="Report errors only: no warnings, no verdict.",
        ),
        click.option("-v", "--verbose", cls=Unrecorded, is_flag=True, help="Report what was read."),
        click.option(
            "--debug", cls=Unrecorded, is_flag=True, help="Show the traceback of an error."
        ),
    )(function)


robot: Callable[[F], F] = click.option(
    "--robot", type=ROBOT, metavar="NAME|FILE",
    help="The robot: scara2, emps, planar2-gravity, or a .toml or .urdf file.  "
    "[default: the robot named in the table's metadata, else $SCARID_ROBOT, else scara2]",
)  # fmt: skip


log_robot: Callable[[F], F] = click.option(
    "--robot", type=ROBOT, metavar="FILE",
    help="A .toml file of the robot, whose [log] says what the columns are, if they have other "
    "names than ours.  [default: $SCARID_ROBOT]",
)  # fmt: skip


def treatment(function: F) -> F:
    """How the rows of the regression are treated, by identify, validate and urdf alike."""
    return all_of(
        heading(METHOD),
        click.option(
            "--skip", type=NUMBERS, metavar="ROWS[,ROWS]",
            help="Leave out this many rows at the start and, if there are two numbers, at the end.",
        ),
        click.option(
            "--decimate", type=NUMBERS, metavar="N[,N...]",
            help="Pass the columns of W and the torques through the same low-pass and keep every "
            "N-th row; repeat this for each N. Holds the whole log in memory.",
        ),
        click.option(
            "--drop-slow", type=NUMBERS, metavar="V[,V...]",
            help="Leave out the rows of a joint that is slower than V [rad/s or m/s], one value "
            "for all joints or one per joint, because near rest Coulomb friction is not sign(dq).",
        ),
        click.option(
            "--all-rows", is_flag=True,
            help="Use the rows near reversals and near standstill as well. By default rows are "
            "left out where a joint reverses within half a period of the motion's bandwidth, or "
            "is slower than 2 % of its root-mean-square velocity so far or than its noise.",
        ),
        click.option(
            "--bandwidth", type=NUMBER, metavar="HZ",
            help="Bandwidth of the motion.  [default: that in the metadata, which "
            "differentiate --match writes and CSV cannot hold]",
        ),
        click.option(
            "--smooth-sign", type=NUMBER, metavar="V",
            help="Model Coulomb friction by tanh(dq / V) instead of sign(dq) [rad/s or m/s].",
        ),
    )(function)  # fmt: skip
