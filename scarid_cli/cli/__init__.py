"""The command line. Each command is declared in a module of its own, loaded when it is called."""

from __future__ import annotations

import importlib
from typing import Any

import click

from scarid_cli import __version__

# In the order of a pipe, with the lines of `scarid --help`, which therefore loads no command.
COMMANDS = {
    "trajgen": "Generate an excitation trajectory.",
    "simulate": "Simulate a robot that follows a trajectory in closed loop.",
    "resample": "Resample a log with a jittered clock at a constant rate.",
    "check": "Check a log before it is identified.",
    "filter": "Low-pass filter columns of a log.",
    "tune": "Find the settings of differentiators from a log.",
    "differentiate": "Estimate velocities and accelerations from positions (the soft sensor).",
    "identify": "Estimate a robot's dynamic parameters from a log.",
    "watch": "Watch the estimates of a robot that moves, at the end of a live pipe.",
    "validate": "Measure how well identified parameters predict torques.",
    "compare": "Tell which parameters of two identifications differ, and how they drift.",
    "payload": "Find what hangs on the flange: mass, centre and inertia.",
    "gains": "Find the gain of each joint's torque from a load that is known.",
    "report": "Print tables and draw figures of parameters, traces, metrics and predictions.",
    "plot": "Draw a table on the terminal, or as an SVG or a PNG.",
    "urdf": "Write identified parameters into a URDF as physically consistent links.",
    "export": "Write identified dynamics as C for a controller.",
    "methods": "List the methods that commands offer, or describe one.",
    "robot": "Check a robot description.",
    "convert": "Convert between table formats, or turn a recorded log into a table.",
    "listen": "Take rows that a robot sends to a port.",
    "tee": "Write a table to a file, and pass it on.",
    "info": "Describe a table: kind, columns, units, sampling, history.",
    "completion": "Print the completion script of a shell.",
    "help": "Explain a command.",
}


class LazyGroup(click.Group):
    """A group that imports a command's module only when the command is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"scarid_cli.cli.{cmd_name}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            from difflib import get_close_matches

            near = get_close_matches(name, COMMANDS, 1)
            ctx.fail(f"no such command {name!r}{f'; did you mean {near[0]}?' if near else ''}")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[Any]:
        """The commands, with the lines of the help, and the options."""
        from click.shell_completion import CompletionItem

        names = [name for name in COMMANDS if name.startswith(incomplete)]
        return [
            *(CompletionItem(name, help=COMMANDS[name]) for name in names),
            *click.Command.shell_complete(self, ctx, incomplete),
        ]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _version(ctx: click.Context, _param: click.Parameter, wanted: bool) -> None:
    if not wanted or ctx.resilient_parsing:
        return
    from scarid_cli.cli.declaring.interpreted import interpreted

    click.echo(f"scarid {__version__} (kernels: {'interpreted' if interpreted() else 'compiled'})")
    ctx.exit()


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120},
    epilog="`scarid help COMMAND` explains a command, with examples.",
)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version,
    help="Show the version and which kernels run.",
)  # fmt: skip
def scarid() -> None:
    """Identify the dynamic parameters of a robot from its log, in one pipe.

    \b
      scarid trajgen --seed 1 | scarid simulate | scarid identify

    Each command reads one table (CSV, Parquet or Arrow) from a FILE or from standard input, and
    writes one to standard output or to -o FILE. The word `then` joins commands like a pipe, but in
    one process, which saves time and keeps units, robot and history:

    \b
      scarid filter --cutoff 20 log.csv then differentiate then identify
    """
