"""What to say of an option that a command does not have, but others do."""

from __future__ import annotations

import click

from scarid_cli.cli import COMMANDS, scarid

NAMED = 3  # commands, at most


def told(error: click.NoSuchOption) -> str:
    """`no such option: --robot; identify, validate and check have it`, or what click says."""
    context = click.Context(scarid)
    others = [
        name
        for name in COMMANDS
        if (command := scarid.get_command(context, name))
        for parameter in command.params
        if error.option_name in (*parameter.opts, *parameter.secondary_opts)
    ]
    if not others:
        return error.format_message().rstrip(".")
    return f"no such option: {error.option_name}; {_listed(others)}"


def _listed(names: list[str]) -> str:
    """`identify, validate and 9 others have it`."""
    if len(names) == 1:
        return f"{names[0]} has it"
    if len(names) <= NAMED:
        return f"{', '.join(names[:-1])} and {names[-1]} have it"
    return f"{', '.join(names[:2])} and {len(names) - 2} others have it"
