"""Commands whose help ends with the description of every choice of a registry."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import Registry


def describing(registry: Registry, heading: str) -> type[click.Command]:
    """A command class whose help describes the choices of this registry."""

    class Described(click.Command):
        def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
            with formatter.section(heading):
                for name in registry.names:
                    formatter.write(f"{' ' * formatter.current_indent}{name}\n")
                    indent = " " * (formatter.current_indent + 2)
                    for line in registry.describe(name).splitlines():
                        formatter.write(f"{indent}{line}".rstrip() + "\n")
                    formatter.write_paragraph()

    return Described
