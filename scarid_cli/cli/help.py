"""scarid help"""

from __future__ import annotations

import click

from scarid_cli.cli.declaring.headings import Command
from scarid_cli.cli.declaring.options import offered


@click.command(name="help", cls=Command)
@click.argument("words", nargs=-1, metavar="[COMMAND]", shell_complete=offered("commands"))
@click.pass_context
def command(ctx: click.Context, words: tuple[str, ...]) -> None:
    """Explain a command, as `scarid COMMAND --help` does; without a COMMAND, list all.

    \b
      scarid help
      scarid help identify
      scarid help robot check
    """
    at = ctx.find_root()
    for word in words:
        if not isinstance(at.command, click.Group):
            ctx.fail(f"{at.command_path} has no commands of its own, such as {word!r}")
        found = at.command.get_command(at, word)
        if found is None:
            at.command.resolve_command(at, [word])  # fails, and says which commands there are
            ctx.fail(f"no such command {word!r} in {at.command_path}")
        at = found.make_context(word, [], parent=at, resilient_parsing=True)
    click.echo(at.get_help())
