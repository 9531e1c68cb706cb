"""Option families: what several commands take, declared once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

F = TypeVar("F", bound=Callable[..., Any])
Decorator = Callable[[F], F]

FORMATS = ("csv", "parquet", "arrow", "arrow-file")  # of io.writer, which `--help` does not load


def _all(*decorators: Callable[[F], F]) -> Callable[[F], F]:
    def decorate(function: F) -> F:
        for decorator in reversed(decorators):
            function = decorator(function)
        return function

    return decorate


def table_input(function: F) -> F:
    """The table to read: FILE, or standard input."""
    return click.argument("file", default="-", metavar="[FILE]")(function)


def table_output(function: F) -> F:
    """Where the table goes and in what format."""
    return _all(
        click.option(
            "-o", "--output", default="-", metavar="FILE",
            help="Write to FILE; its extension tells the format "
            "(.csv, .parquet, .arrow file, .arrows stream).  [default: standard output]",
        ),
        click.option(
            "--format", type=click.Choice(FORMATS),
            help="Format of the output.  [default: by extension, else $SCARID_FORMAT, else csv]",
        ),
        click.option(
            "--no-history", is_flag=True, help="Leave the history out of the metadata."
        ),
    )(function)  # fmt: skip


def common(function: F) -> F:
    """What every command takes."""
    return _all(
        click.option("-q", "--quiet", is_flag=True, help="Say nothing but errors."),
        click.option("-v", "--verbose", is_flag=True, help="Say what was read."),
        click.option("--debug", is_flag=True, help="Show the traceback of an error."),
    )(function)


robot: Callable[[F], F] = click.option(
    "--robot", metavar="NAME",
    help="scara2, emps, planar2-gravity, or a .toml or .urdf file.  "
    "[default: the table's robot, else scara2]",
)  # fmt: skip


class Numbers(click.ParamType[tuple[float, ...]]):
    """One number for all joints, or one per joint separated by commas."""

    name = "number[,number...]"

    def convert(self, value: Any, param: Any, ctx: Any) -> tuple[float, ...]:
        if isinstance(value, tuple):
            return value
        try:
            return tuple(float(part) for part in value.split(","))
        except ValueError:
            self.fail(f"{value!r} is not a number, or numbers separated by commas", param, ctx)


NUMBERS = Numbers()


def treatment(function: F) -> F:
    """What is done to the rows of the regression, for identify and validate alike."""
    return _all(
        click.option(
            "--skip", type=NUMBERS, metavar="ROWS[,ROWS]",
            help="Leave out so many rows at the start, and at the end.",
        ),
        click.option(
            "--decimate", type=NUMBERS, metavar="N[,N...]",
            help="Low-pass every column of W and the torques alike, and keep every N-th row; "
            "several times if several are given. Holds the whole log.",
        ),
        click.option(
            "--drop-slow", type=NUMBERS, metavar="V[,V...]",
            help="Leave out the rows of a joint slower than this [rad/s or m/s], one value or one "
            "a joint: there dry friction is not sign(dq).",
        ),
        click.option(
            "--smooth-sign", type=float, metavar="V",
            help="Let dry friction change over this velocity, tanh(dq / V), instead of at once.",
        ),
    )(function)  # fmt: skip
