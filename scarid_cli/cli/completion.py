"""scarid completion"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli.declaring import completing, options


@click.command(name="completion")
@click.argument("shell", type=click.Choice(completing.SHELLS), metavar="bash|zsh|fish")
@options.common
@click.pass_context
def command(ctx: click.Context, /, shell: str, **_rest: Any) -> None:
    """Print the script by which a shell completes the command line at the Tab key.

    \b
      bash   ~/.bashrc                    eval "$(scarid completion bash)"
      zsh    ~/.zshrc, after compinit     eval "$(scarid completion zsh)"
      fish   ~/.config/fish/config.fish   scarid completion fish | source

    \b
      scarid completion bash > scarid.bash
      scarid completion fish > scarid.fish

    The Tab key then completes commands, options and their values: methods and their settings,
    robots, presets, imperfections, parameters of the robot, columns of the table on the line, and
    files; also in the commands after `then`. It needs bash 4.4 or newer.
    """
    group = ctx.find_root().command
    assert isinstance(group, click.Group)
    click.echo(completing.script(group, shell))
