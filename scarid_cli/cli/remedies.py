"""What to type where a log has no constant rate, or lacks values: the whole pipe."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import click

from scarid_cli.cli.command_line import command_line, given_words
from scarid_cli.cli.options import SELECTION
from scarid_cli.errors import CORRECT

if TYPE_CHECKING:
    import pyarrow as pa

    from scarid_cli.io.remedies import Remedies

DROP = "--missing drop"
WINDOW = [name for name in SELECTION if name != "missing"]


@dataclass(frozen=True)
class Pipe:
    """Commands that resample a table before this one reads it; `words` follow the rate."""

    before: str
    words: Sequence[str]
    after: str

    def at(self, rate: str) -> str:
        """The pipe, given the rate [Hz]."""
        first = " ".join(["scarid resample --rate", rate, *self.words])
        return f"{self.before}{first}{self.after}"


def remedies(path: str, *, regular: bool) -> Remedies:
    """The remedies for the table at this path, whose clock has to be `regular` or need not be.

    The words are those of the command line now: when a fault is found, a later stage may run.
    """
    from scarid_cli.io.remedies import Remedies  # pyarrow, which `--help` does not need

    if not regular:
        return Remedies(value=lambda _: f"{CORRECT}, or leave such rows out with {DROP}")
    constant = partial(
        _text, "put it on a constant rate with", _pipe(path, given_words(["missing"]))
    )
    if "missing" not in click.get_current_context().params:
        return Remedies(clock=constant)
    whole = partial(_text, f"{CORRECT}, or leave it out with", _pipe(path, [DROP]))
    return Remedies(value=whole, clock=constant)


def _text(start: str, pipe: Pipe, rows: pa.RecordBatch) -> str:
    from scarid_cli.stages.rates import advised_rate

    return f"{start} `{pipe.at(advised_rate(rows))}`"


def _pipe(path: str, missing: list[str]) -> Pipe:
    """The pipe for one of the command's logs, or for a table that it reads beside them."""
    name = [] if path == "-" else [shlex.quote(path)]
    parameters = click.get_current_context().params
    files = list(parameters.get("files", [parameters.get("file")])) or ["-"]
    if path not in files:
        return Pipe("", [*missing, *name], "")
    if len(files) == 1:
        words = [*given_words(WINDOW), *missing, "--format arrow", *name]
        return Pipe("", words, f" | {command_line(without=('file', 'files', *SELECTION))}")
    at = files.index(path)
    before = [command_line(without=("files",)), *map(shlex.quote, files[:at]), "<("]
    after = "".join(f" {shlex.quote(file)}" for file in files[at + 1 :])
    return Pipe(" ".join(before), [*missing, "--format arrow", *name], f"){after}")
