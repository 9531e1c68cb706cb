"""A command is declared in one module, for `--help`, and acts in another, imported when it runs."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from typing import Any

import click
from click.core import ParameterSource

from scarid_cli.cli.declaring.headings import Command
from scarid_cli.cli.declaring.options import SHARED

# Commands that spend no time in kernels, and are as quick without a C compiler.
WITHOUT_KERNELS = ("compare", "convert", "info", "listen", "plot", "report", "tee")
READABLE = ("identify", "validate", "tune")  # whose tables a person reads on a terminal


def _require_values() -> None:
    """Refuse an empty value, which is most likely that of a variable of the shell that is unset."""
    context = click.get_current_context()
    for parameter in context.command.params:
        name = parameter.name or ""
        given = context.get_parameter_source(name) is ParameterSource.COMMANDLINE
        value = context.params.get(name)
        if given and "" in (value if isinstance(value, tuple) else (value,)):
            text = "the value is empty; give one, or leave the option out"
            raise click.BadParameter(text, param=parameter)


def _only_json(given: dict[str, Any]) -> bool:
    """Whether a JSON document takes the place of the table; with -o FILE, both are written."""
    return bool(given.get("as_json")) and given.get("output", "-") == "-"


def declare(
    name: str, cls: type[click.Command] = Command
) -> Callable[[Callable[[], None]], click.Command]:
    """Make a command of its click options and its help text, which is a function's docstring.

    The action is the function `run` of `scarid_cli.cli.actions.NAME`. It is given the job, with
    the output of `options.table_output` open, and the command's own options. What it returns, if
    anything, is the exit status of a run that is complete.
    """

    def decorate(declaration: Callable[[], None]) -> click.Command:
        @functools.wraps(declaration)
        def called(**given: Any) -> None:
            from scarid_cli.cli.running.job import job

            _require_values()
            action = importlib.import_module(f"scarid_cli.cli.actions.{name}")
            own = {option: value for option, value in given.items() if option not in SHARED}
            with job(given) as run:
                if name not in WITHOUT_KERNELS:
                    run.say_if_interpreted()
                if "format" in given and not _only_json(given):
                    small = name in READABLE
                    run.out = run.output(given.get("output", "-"), given["format"], readable=small)
                status = action.run(run, **own)
            if status:
                raise click.exceptions.Exit(status)

        return click.command(name=name, cls=cls)(called)

    return decorate
