"""The command line as the history records it."""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli.options import Unrecorded


def command_line(*, without: str = "") -> str:
    """The command line, in a fixed order, without the options that change nothing in the table.

    One more parameter may be left out, by its name.
    """
    context = click.get_current_context()
    words = [context.info_name or ""]
    for parameter in context.command.params:
        name = parameter.name or ""
        if isinstance(parameter, Unrecorded) or not was_given(name) or name == without:
            continue
        words += _words(parameter, context.params[name])
    return " ".join(["scarid", *words])


def was_given(name: str) -> bool:
    """Whether a parameter of the command is on its command line."""
    source = click.get_current_context().get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


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
