"""The command line of this run, as the history and the messages repeat it."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import click

from scarid_cli.cli.declaring.options import InputFile, OutputFile, Unrecorded

PLACE = "place"  # the argument of `tee`


def command_line(*, without: Collection[str] = ()) -> str:
    """The command line, in a fixed order, without the options that change nothing in the table.

    Other parameters may be left out, by their names.
    """
    context = click.get_current_context()
    names = [p.name or "" for p in context.command.params if not isinstance(p, Unrecorded)]
    start = f"scarid {context.info_name or ''}"
    return " ".join([start, *given_words([name for name in names if name not in without])])


def given_words(names: Collection[str]) -> list[str]:
    """The words of those of these parameters that are on the command line."""
    context = click.get_current_context()
    given = [p for p in context.command.params if p.name in names and was_given(p.name)]
    return [word for p in given for word in _words(p, context.params[p.name or ""])]


def inputs(context: click.Context) -> list[str]:
    """The files that a command reads, without those of its options."""
    read = [p for p in context.command.params if _is_argument(p) and isinstance(p.type, InputFile)]
    values = [context.params[p.name or ""] for p in read]
    return [str(v) for value in values for v in (value if isinstance(value, tuple) else (value,))]


def outputs(context: click.Context) -> list[str]:
    """The files that a command writes beside standard output, as its command line names them."""
    written = [
        p
        for p in context.command.params
        if isinstance(p, OutputFile) or (_is_argument(p) and p.name == PLACE)
    ]
    values = [context.params[p.name or ""] for p in written]
    return [str(value) for value in values if value and value != "-"]


def other_inputs(context: click.Context) -> list[str]:
    """The files that the options of a command read."""
    read = [p for p in context.command.params if isinstance(p.type, InputFile)]
    pairs = [(p.type, context.params[p.name or ""]) for p in read]
    listed = [
        kind.file(str(v))
        for kind, value in pairs
        for v in (value if isinstance(value, tuple) else (value,))
        if isinstance(kind, InputFile)
    ]
    return [file for file in listed if file not in ("None", "-")]


def _is_argument(parameter: click.Parameter) -> bool:
    return isinstance(parameter, click.Argument)


def was_given(name: str) -> bool:
    """Whether a parameter of the command is on its command line."""
    source = click.get_current_context().get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _words(parameter: click.Parameter, value: Any) -> list[str]:
    import shlex

    if _is_argument(parameter):
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
