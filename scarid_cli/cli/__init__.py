"""The command line: click only. One file per command, loaded when it is called."""

from __future__ import annotations

import importlib

import click

from scarid_cli import __version__

# In the order of the pipe, each with its line of `scarid --help`, so that the help loads nothing.
COMMANDS = {
    "trajgen": "Generate an excitation trajectory.",
    "simulate": "Let a simulated robot follow a trajectory, in closed loop.",
    "resample": "Put a log with a jittered clock on a regular one.",
    "filter": "Low-pass filter columns of a log.",
    "tune": "Find settings of differentiators in a log, without the truth.",
    "differentiate": "Estimate velocities and accelerations from positions (the soft sensor).",
    "identify": "Estimate a robot's dynamic parameters from a motion.",
    "validate": "Predict torques with identified parameters, and measure how well.",
    "report": "Tables and figures of parameters, traces, metrics and predictions.",
    "urdf": "Put identified parameters into a URDF, as bodies that can exist.",
    "robot": "Tell what was understood of a robot description.",
    "convert": "Change the format of a table, or make a table of a lab's log.",
    "info": "Show what a table is: kind, columns, units, sampling, history.",
}


class LazyGroup(click.Group):
    """A group that imports a command's file only when the command is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"scarid_cli.cli.{cmd_name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


def _version(ctx: click.Context, _param: click.Parameter, wanted: bool) -> None:
    if not wanted or ctx.resilient_parsing:
        return
    click.echo(f"scarid {__version__} (kernels: {kernels()})")
    ctx.exit()


def kernels() -> str:
    """Whether the compiled or the interpreted kernels run."""
    from importlib.util import find_spec
    from pathlib import Path

    folder = Path(__file__).parent.parent / "kernels"
    specs = [find_spec(f"scarid_cli.kernels.{path.stem}") for path in folder.glob("[a-z]*.py")]
    origins = [spec.origin or "" for spec in specs if spec]
    return "interpreted" if any(origin.endswith(".py") for origin in origins) else "compiled"


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="`scarid COMMAND --help` explains one command, with examples.",
)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_version,
    help="Show the version and which kernels run.",
)  # fmt: skip
def scarid() -> None:
    """From a robot's log to dynamic parameters you can trust, in one pipe.

    \b
      scarid trajgen --seed 1 | scarid simulate | scarid filter |
        scarid differentiate --method p2smd | scarid identify

    Each command reads one table (CSV, Parquet or Arrow, from a FILE or standard input) and writes
    one (to standard output or -o FILE).
    """
