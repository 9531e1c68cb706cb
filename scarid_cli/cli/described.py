"""Commands whose help ends with the description of every choice of a registry."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import Registry


def describing(registry: Registry, heading: str, *, brief: bool = False) -> type[click.Command]:
    """A command class whose help describes the choices of this registry.

    A `brief` help has their first lines only, and names the command that shows the rest.
    """

    class Described(click.Command):
        def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
            if brief:
                with formatter.section(f"{heading} (`scarid methods NAME` describes one)"):
                    lines = [(n, registry.describe(n).splitlines()[0]) for n in registry.names]
                    width = max(map(len, registry.names))
                    for name, line in lines:
                        formatter.write(f"  {name:<{width}}  {line}\n")
                return
            with formatter.section(heading):
                for name in registry.names:
                    formatter.write(f"{' ' * formatter.current_indent}{name}\n")
                    indent = " " * (formatter.current_indent + 2)
                    for line in registry.describe(name).splitlines():
                        formatter.write(f"{indent}{line}".rstrip() + "\n")
                    formatter.write_paragraph()

    return Described
