"""The options of a command under headings, in the help: the data, the method, the output ..."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])

DATA, METHOD, ERRORS, OUTPUT = "The data", "The method", "The errors", "The output"
MODEL = "The model"
KEY = "heading"
WIDEST = 30  # characters: the help of a longer option begins on the next line


def heading(title: str) -> Callable[[F], F]:
    """Put the options below, down to the next heading, under this one."""

    def decorate(function: F) -> F:
        # Decorators apply from the bottom up: what has no heading yet stands below this one.
        for parameter in getattr(function, "__click_params__", []):
            vars(parameter).setdefault(KEY, title)
        return function

    return decorate


class Command(click.Command):
    """A command whose help has its options under their headings."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        parameters = [p for p in self.get_params(ctx) if isinstance(p, click.Option)]
        sections: dict[str, list[tuple[str, str]]] = {}
        for parameter in parameters:
            # What the command does not declare is click's `--help`: it stands beside --quiet.
            own = parameter in self.params
            title = vars(parameter).get(KEY, "Options") if own else OUTPUT
            if record := parameter.get_help_record(ctx):
                sections.setdefault(title, []).append(record)
        names = [name for records in sections.values() for name, _ in records]
        width = min(WIDEST, max(map(len, names)))
        for title, records in sections.items():
            with formatter.section(title):
                formatter.write_dl([(f"{name:<{width}}", text) for name, text in records])
