"""What the pages of several commands have in common: exit statuses, files, environment."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import click

from scarid_cli.cli.declaring.options import ROBOT, InputFile, OutputFile

Entries = list[tuple[str, str]]  # a term, and what it means
Condition = Callable[[click.Command], bool]


def _any(_command: click.Command) -> bool:
    return True


def _has(name: str) -> Condition:
    return lambda command: any(parameter.name == name for parameter in command.params)


def _reads(command: click.Command) -> bool:
    files = any(isinstance(parameter.type, InputFile) for parameter in command.params)
    return files or _has("port")(command)


def _takes_robot(command: click.Command) -> bool:
    return any(parameter.type is ROBOT for parameter in command.params)


def _reads_table(command: click.Command) -> bool:
    files = [p.type for p in command.params if isinstance(p.type, InputFile)]
    return any("" in kind.endings for kind in files) or _has("place")(command)


def _writes(command: click.Command) -> bool:
    return any(isinstance(parameter, OutputFile) for parameter in command.params)


STATUSES: list[tuple[Condition, str, str]] = [
    (_any, "0", "Success."),
    (_any, "1", "An error in scarid itself; --debug shows the traceback."),
    (_has("strict"), "1", "With `check --strict`: there are warnings, and no check failed."),
    (_any, "2", "Wrong usage: an option or argument that is not valid."),
    (_has("require"), "3", "The verdict is not what --require asks for; the table is complete."),
    (_reads, "65", "Bad data: the input is not what the command needs."),
    (_has("strict"), "65", "With `check`: a check of the log failed."),
    (_any, "74", "Reading or writing failed."),
    (_any, "130", "Interrupted (Ctrl-C, SIGINT). A live input ends instead, with status 0."),
    (_any, "141", "The reader of the pipe closed it early (SIGPIPE)."),
    (_any, "143", "Asked to end (SIGTERM). A live input ends instead, with status 0."),
]

FILES: list[tuple[Condition, str, str]] = [
    (
        _reads_table,
        "-",
        "Standard input. A table is CSV, Parquet or Arrow, which its first bytes tell.",
    ),
    (
        _writes,
        "FILE.csv, FILE.parquet, FILE.arrow, FILE.arrows",
        "A table in the format of the extension; CSV holds no metadata. An output file appears "
        "when it is whole: a command that fails leaves none, and what was there before stays.",
    ),
    (
        _takes_robot,
        "ROBOT.toml, ROBOT.urdf",
        "A description of a robot. `scarid robot check` shows how it is understood.",
    ),
]

ENVIRONMENT: list[tuple[Condition, str, str]] = [
    (
        _takes_robot,
        "SCARID_ROBOT",
        "The robot of tables whose metadata states none, where there is no --robot.",
    ),
    (
        _has("format"),
        "SCARID_FORMAT",
        "The format of tables on standard output: csv, parquet or arrow. An option or the "
        "extension of -o FILE comes first.",
    ),
    (
        _reads_table,
        "SCARID_MAX_BATCH",
        "How many megabytes a part of an input may unfold to.",
    ),
    (_any, "COLUMNS", "The width of the text, in place of that of the terminal."),
    (_any, "NO_COLOR", "If it is set, nothing is coloured; nor is it if TERM is dumb."),
]


def of(command: click.Command, known: list[tuple[Condition, str, str]]) -> Entries:
    """Those entries that concern a command; entries with the same term become one."""
    return _merged((term, text) for concerns, term, text in known if concerns(command))


def every(known: list[tuple[Condition, str, str]]) -> Entries:
    """The entries of all commands, for the page of scarid itself."""
    return _merged((term, text) for _, term, text in known)


def _merged(entries: Iterable[tuple[str, str]]) -> Entries:
    found: dict[str, str] = {}
    for term, text in entries:
        found[term] = f"{found[term]} {text}" if term in found else text
    return list(found.items())
