"""A command is declared in one module, for `--help`, and acts in another, imported when it runs."""

from __future__ import annotations

import functools
import importlib
from collections.abc import Callable
from typing import Any

import click

from scarid_cli.cli.options import SHARED

READABLE = ("identify", "validate", "tune")  # whose tables a person reads on a terminal


def declare(
    name: str, cls: type[click.Command] = click.Command
) -> Callable[[Callable[[], None]], click.Command]:
    """Make a command of its click options and its help text, which is a function's docstring.

    The action is the function `run` of `scarid_cli.cli.actions.NAME`. It is given the job, with
    the output of `options.table_output` open, and the command's own options. What it returns, if
    anything, is the exit status of a run that is complete.
    """

    def decorate(declaration: Callable[[], None]) -> click.Command:
        @functools.wraps(declaration)
        def called(**given: Any) -> None:
            from scarid_cli.cli.job import job

            action = importlib.import_module(f"scarid_cli.cli.actions.{name}")
            own = {option: value for option, value in given.items() if option not in SHARED}
            with job(given) as run:
                if "format" in given:
                    small = name in READABLE
                    run.out = run.output(given["output"], given["format"], readable=small)
                status = action.run(run, **own)
            if status:
                raise click.exceptions.Exit(status)

        return click.command(name=name, cls=cls)(called)

    return decorate
