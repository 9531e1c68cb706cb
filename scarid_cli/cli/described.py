"""Help that lists every choice of a registry; `scarid methods NAME` describes one."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import Registry


def listed(registry: Registry) -> str:
    """The names of all choices, for the help of an option."""
    return ", ".join(registry.names)


def describing(registry: Registry, heading: str) -> type[click.Command]:
    """A command class whose help ends with a line on each choice of this registry."""

    class Described(click.Command):
        def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
            with formatter.section(f"{heading} (`scarid methods NAME` describes one)"):
                lines = [(name, registry.describe(name).splitlines()[0]) for name in registry.names]
                formatter.write_dl(lines)

    return Described
