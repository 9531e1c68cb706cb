"""Help that lists every choice of a registry; `scarid methods NAME` describes one."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import Registry
from scarid_cli.cli.declaring.headings import Command


def listed(registry: Registry) -> str:
    """The names of all choices, for the help of an option."""
    return ", ".join(registry.names)


def recommended(registry: Registry) -> str:
    """Which choices to begin with, for the help of an option."""
    return ", ".join(f"{name} {use}" for name, use in registry.recommended.items())


def describing(registry: Registry, heading: str) -> type[click.Command]:
    """A command class whose help ends with a line on each choice of this registry."""

    class Described(Command):
        def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
            with formatter.section(f"{heading} (`scarid methods NAME` describes one)"):
                lines = [(name, registry.summary(name)) for name in registry.names]
                formatter.write_dl(lines)

    return Described
