"""A command as a function: its words from Python values, its table from the run."""

from __future__ import annotations

import contextlib
import inspect
import keyword
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import click
import numpy as np
import pyarrow as pa
from pyarrow import compute as pc

from scarid import tables
from scarid.results import Checked, RequirementError, Text, result
from scarid_cli.cli import COMMANDS as ALL
from scarid_cli.cli import scarid as group
from scarid_cli.cli.declaring.options import InputFile
from scarid_cli.cli.running import chain
from scarid_cli.errors import BAD_DATA, ScaridError, UsageFault
from scarid_cli.io.table import Metadata, Table

# What only a shell needs.
LEFT_OUT = ("listen", "watch", "tee", "methods", "robot", "help", "completion", "plot")
READ = "read"  # the name of `convert`, which reads any log
COMMANDS = (READ, *(name for name in ALL if name not in LEFT_OUT))
# What a log is like is what `check` tells: no error, but with `strict`.
TOLD = {"check": BAD_DATA}
# What the function itself decides.
OWN = ("format", "output", "help", "as_json", "quiet", "verbose", "debug")


def function(name: str) -> Callable[..., Any]:
    """The function of a command, with its signature and its help."""
    command = of_name(name)

    def called(*tables: Any, **options: Any) -> Any:
        return run(command, tables, options)

    called.__name__ = called.__qualname__ = name
    called.__module__ = "scarid"
    called.__signature__ = signature(command)  # type: ignore[attr-defined]
    called.__doc__ = documentation(command)
    return called


def of_name(name: str) -> click.Command:
    """The command that a function stands for."""
    with click.Context(group, info_name="scarid") as context:
        command = group.get_command(context, "convert" if name == READ else name)
    assert command is not None
    return command


def options_of(command: click.Command) -> dict[str, click.Option]:
    """The options of a function by their names: those of the command line, with underscores."""
    own = [p for p in command.params if isinstance(p, click.Option) and p.name not in OWN]
    return {python_name(option): option for option in own}


def python_name(option: click.Option) -> str:
    """`--from-time` is from_time, and `--from` is from_, as `from` is a word of Python."""
    longest = max(option.opts, key=len)
    name = longest.lstrip("-").replace("-", "_")
    return f"{name}_" if keyword.iskeyword(name) else name


def writes_table(command: click.Command) -> bool:
    """Whether the command has a table, and not a text, for a result."""
    return any(p.name == "format" for p in command.params)


def signature(command: click.Command) -> inspect.Signature:
    """The inputs by position, the options by name."""
    parameters = []
    if any(isinstance(p, click.Argument) for p in command.params):
        parameters.append(inspect.Parameter("tables", inspect.Parameter.VAR_POSITIONAL))
    parameters += [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None)
        for name in options_of(command)
    ]
    return inspect.Signature(parameters)


def documentation(command: click.Command) -> str:
    """The help of the command, and its options as they are called here."""
    lines = [inspect.cleandoc(command.help or "").replace("\b\n", ""), "", "Options:"]
    for name, option in options_of(command).items():
        lines.append(f"    {name}: {' '.join((option.help or '').split())}")
    return "\n".join(lines)


def run(command: click.Command, inputs: Sequence[Any], options: Mapping[str, Any]) -> Any:
    """Run a command on tables in memory or files, and return its result.

    Raises the error that the command would have reported; RequirementError, with the result, where
    the exit status says that the log or the result is not as it should be.
    """
    with tempfile.TemporaryDirectory(prefix="scarid-") as folder:
        given = Given(command, Path(folder))
        source, words = given.inputs(inputs, options)
        words = [*given.options(options), *words]
        messages: list[str] = []
        tables_out: list[Table] = []

        def taken(table: Table) -> None:
            held = [_with_names(folder, batch) for batch in table.batches]
            meta = Metadata.from_json(_without(folder, table.meta.to_json().decode()).encode())
            tables_out.append(replace(table, batches=iter(held), meta=meta))

        has_table = writes_table(command)
        printed: list[str] = []
        place = chain.Place(
            lambda line: messages.append(click.unstyle(line).replace("\n", " ")),
            source,
            taken if has_table else None,
            shown=printed.append,
        )
        with _plain_errors(folder):
            status = chain.called(group, [command.name or "", *words], place)
        said = [_without(folder, line) for line in messages]
        if has_table and tables_out:
            found: Any = result(tables_out[0], said)
        else:
            text = _without(folder, given.text("".join(printed)))
            checked = command.name == "check" and text.startswith("{")
            found = (Checked if checked else Text)(text, said)
    told = TOLD.get(command.name or "") == status and not options.get("strict")
    if status and not told:
        text = said[-1] if said else _worst(found) or f"exit status {status}"
        raise RequirementError(text, status, found)
    return found


def _with_names(folder: str, batch: pa.RecordBatch) -> pa.RecordBatch:
    """The same for the texts of a table."""
    columns = [
        pc.replace_substring(column, f"{folder}/", "")
        if pa.types.is_string(column.type)
        else column
        for column in batch.columns
    ]
    return pa.RecordBatch.from_arrays(columns, schema=batch.schema)


def _worst(found: Text) -> str:
    """What a document of `check` says is worst; nothing if it is another text."""
    if not found.startswith("{"):
        return ""
    data = found.data
    findings = [x for x in data["checks"] if x["status"] == data["status"]]
    return "; ".join(f"{x['name']}: {x['figure']}" for x in findings)


def _without(folder: str, text: str) -> str:
    """The text with the names of tables in memory, and not the paths at which they stood."""
    return text.replace(f"{folder}/", "")


@contextlib.contextmanager
def _plain_errors(folder: str) -> Iterator[None]:
    """Raise the error of a command as itself, and one of its words as UsageFault."""
    try:
        yield
    except chain.StageFailed as failure:
        if isinstance(failure.error, ScaridError):
            failure.error.args = tuple(_without(folder, str(x)) for x in failure.error.args)
        raise failure.error from None
    except click.UsageError as error:
        raise UsageFault(_without(folder, error.format_message().rstrip("."))) from None


class Given:
    """What was given to a function, as the words of a command line.

    Tables beside the one on standard input go through files in a `folder`.
    """

    def __init__(self, command: click.Command, folder: Path) -> None:
        self._command = command
        self._folder = folder
        self._document: Path | None = None

    def inputs(self, given: Sequence[Any], options: Mapping[str, Any]) -> tuple[Any, list[str]]:
        """The table in place of standard input, and the words for all inputs."""
        flat = [x for one in given for x in (one if isinstance(one, list | tuple) else [one])]
        argument = next((p for p in self._command.params if isinstance(p, click.Argument)), None)
        if argument is None:
            if flat:
                raise UsageFault(f"{self._command.name} takes no table")
            return None, []
        if len(flat) == 1 and not tables.is_path(flat[0]):
            from scarid_cli.io.arrowio import Handed

            return Handed(tables.table_of(flat[0])), ["--", "-"]
        if not flat:
            if argument.name in ("file", "files") and not options.get("fleet"):
                raise UsageFault(f"{self._command.name}: give a table or the path of one")
            return None, []
        return None, ["--", *(self._file(x, f"table{i}") for i, x in enumerate(flat, 1))]

    def options(self, given: Mapping[str, Any]) -> list[str]:
        """The words of all options."""
        known = options_of(self._command)
        words = []
        for name, value in given.items():
            if name == "output" and not writes_table(self._command):
                words += ["--output", str(value)]
                self._document = Path(value)
                continue
            if name not in known:
                names = ", ".join(known)
                raise UsageFault(f"{self._command.name}: no option {name!r}; there are {names}")
            words += self._words(name, known[name], value)
        if self._has("as_json") and not writes_table(self._command):
            words.append("--json")
        elif self._has("place") and self._document is None and self._command.name != "report":
            self._document = self._folder / "document"
            words += ["--output", str(self._document)]
        return words

    def text(self, printed: str) -> str:
        """The document of a command without a table: what it printed, or the file it wrote."""
        if self._document and self._document.parent == self._folder:
            return self._document.read_text(encoding="utf-8")
        return printed

    def _has(self, name: str) -> bool:
        return any(p.name == name for p in self._command.params)

    def _words(self, name: str, option: click.Option, value: Any) -> list[str]:
        word = max(option.opts, key=len)
        if value is None:
            return []
        if option.is_flag != isinstance(value, bool | np.bool_):
            wanted = "True or False" if option.is_flag else "a value"
            raise UsageFault(f"{self._command.name}: {name} is {value!r}; give {wanted}")
        if option.is_flag:
            return [word] if value else option.secondary_opts[:1]
        if isinstance(option.type, InputFile):
            several = value if isinstance(value, list | tuple) else [value]
            files = [self._file(x, f"{name}{i or ''}") for i, x in enumerate(several)]
            return [w for file in files for w in (word, file)]
        if isinstance(value, Mapping):
            pairs = [f"{key}={_plain(x)}" for key, x in value.items()]
            return [w for pair in pairs for w in (word, pair)]
        if option.nargs > 1:
            return [word, *(str(value).split() if isinstance(value, str) else map(_plain, value))]
        if option.multiple and isinstance(value, list | tuple):
            return [w for x in value for w in (word, _plain(x))]
        return [word, tables.path_of(_plain(value))]

    def _file(self, value: Any, name: str) -> str:
        """The path of a table, which is written to the folder if it is in memory."""
        if tables.is_path(value):
            return tables.path_of(value)
        path = self._folder / f"{name}.parquet"
        tables.write(value, path)
        return str(path)


def _plain(value: Any) -> str:
    """A value as it is typed; numbers keep every digit."""
    if isinstance(value, str | Path):
        return str(value)
    if isinstance(value, Sequence) or hasattr(value, "tolist"):
        listed = value.tolist() if hasattr(value, "tolist") else list(value)
        if isinstance(listed, list):
            return ",".join(map(_plain, listed))
        return _plain(listed)
    return repr(value) if isinstance(value, float) else str(value)
