"""The types of the functions, for editors and type checkers: `python -m scarid.stubs`.

They are written from the declarations of the commands into `scarid/__init__.pyi`; a test compares.
"""

from __future__ import annotations

import sys

import click

from scarid.calls import COMMANDS, documentation, of_name, options_of, writes_table
from scarid_cli.cli.declaring.options import InputFile

HEAD = '''"""The commands of scarid as functions on tables (written by `python -m scarid.stubs`)."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from scarid.results import Checked as Checked
from scarid.results import Judged as Judged
from scarid.results import Log as Log
from scarid.results import RequirementError as RequirementError
from scarid.results import Text as Text
from scarid_cli.errors import BadData as BadData
from scarid_cli.errors import OutputFailure as OutputFailure
from scarid_cli.errors import ScaridError as ScaridError
from scarid_cli.errors import UsageFault as UsageFault

__version__: str

Values = float | str | Sequence[float]
Settings = Mapping[str, Any] | Sequence[str] | str
TableLike = Any  # a path, a Log, a frame of pandas or polars, an Arrow table, or columns
'''
JUDGED = ("identify", "validate", "compare")


def text() -> str:
    """The whole stub."""
    return "\n".join([HEAD, *(_function(name) for name in COMMANDS)])


def _function(name: str) -> str:
    command = of_name(name)
    lines = [f"def {name}("]
    if any(isinstance(p, click.Argument) for p in command.params):
        lines.append("    *tables: TableLike,")
    else:
        lines.append("    *,")
    lines += [f"    {key}: {_type(x)} | None = None," for key, x in options_of(command).items()]
    lines.append(f") -> {_result(name, command)}:")
    help_ = documentation(command).replace("\\", "\\\\").replace('"""', "'''")
    body = "\n".join(f"    {line}".rstrip() for line in f'"""{help_}\n"""'.splitlines())
    return "\n".join([*lines, body, ""])


def _result(name: str, command: click.Command) -> str:
    """The type of what the function returns."""
    if name == "check":
        return "Checked"
    return "Judged" if name in JUDGED else "Log" if writes_table(command) else "Text"


def _type(option: click.Option) -> str:
    """The annotation of an option."""
    if option.is_flag:
        return "bool"
    if isinstance(option.type, click.Choice):
        one = f"Literal[{', '.join(repr(x) for x in option.type.choices)}]"
        return f"Sequence[{one}] | {one}" if option.multiple else one
    if isinstance(option.type, InputFile):
        return "TableLike"
    return "Settings" if option.multiple else "Values"


if __name__ == "__main__":
    sys.stdout.write(text())
