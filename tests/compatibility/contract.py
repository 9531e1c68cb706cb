"""What a version promises: columns, options with their choices, exit statuses."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click

from scarid_cli.cli import COMMANDS, scarid
from scarid_cli.cli.manual import common
from scarid_cli.io import schemas

Contract = dict[str, Any]
SCHEMAS = sorted((Path(__file__).parents[2] / "schemas").glob("*.json"))


def contract() -> Contract:
    """Of this version."""
    return {
        "columns": {path.stem: columns(path.stem) for path in SCHEMAS},
        "options": {name: options(command) for name, command in commands()},
        "statuses": [status for status, _ in common.every(common.STATUSES)],
    }


def columns(kind: str) -> Contract:
    """The type and the units of each column, and whether every table of this kind has it."""
    return {
        field.name: {
            "type": str(field.type),
            "units": list(field.units),
            "required": field.required,
        }
        for field in schemas.load(kind).fields
    }


def commands() -> Iterator[tuple[str, click.Command]]:
    """Every command, and those of groups."""
    context = click.Context(scarid)
    for name in COMMANDS:
        command = scarid.get_command(context, name)
        assert command
        yield name, command
        if isinstance(command, click.Group):
            yield from ((f"{name} {part}", own) for part, own in command.commands.items())


def options(command: click.Command) -> Contract:
    """The spellings of each option, and its choices, if it has any."""
    found = [p for p in command.params if isinstance(p, click.Option)]
    return {
        spelling: list(p.type.choices) if isinstance(p.type, click.Choice) else []
        for p in found
        for spelling in (*p.opts, *p.secondary_opts)
    }


if __name__ == "__main__":
    json.dump(contract(), sys.stdout, indent=1, sort_keys=True)
    print()
