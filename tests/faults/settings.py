"""Values of options and of the environment that nobody should give."""

from __future__ import annotations

import os
from collections.abc import Iterator

import click
import numpy as np
from faults.material import files
from faults.trials import Trial, folder_of, removed

VALUES = ("", "nan", "inf", "-1", "0", "1e-300", "1e300", "1e9", str(2**63), "x", "1,2,3", "../x",
          "1" * 5000, "\x1b[2J")  # fmt: skip
INPUTS = {
    "simulate": ("reference.parquet",),
    "validate": ("motion.parquet", "--parameters", "par.parquet"),
    "compare": ("par.parquet", "par.parquet"),
    "export": ("--parameters", "par.parquet"),
    "payload": ("par.parquet", "--parameters", "par.parquet"),
    "gains": ("par.parquet", "--parameters", "par.parquet", "--mass", "1"),
    "report": ("par.parquet",),
    "trajgen": (),
    "listen": ("--port", "5998", "--idle", "0.01"),
}
COMMANDS = ("trajgen", "simulate", "resample", "check", "filter", "tune", "differentiate",
            "identify", "watch", "validate", "compare", "payload", "gains", "export", "report",
            "plot", "convert", "listen", "info")  # fmt: skip
ENVIRONMENTS = (
    {"SCARID_FORMAT": "x"}, {"SCARID_FORMAT": ""}, {"SCARID_ROBOT": "x"}, {"SCARID_ROBOT": ""},
    {"SCARID_MAX_BATCH": "x"}, {"SCARID_MAX_BATCH": "0"}, {"SCARID_MAX_BATCH": "1"},
    {"COLUMNS": "0"}, {"COLUMNS": "x"}, {"COLUMNS": "1" * 30}, {"TMPDIR": "/nowhere"}, {"HOME": ""},
    {"LANG": "x", "LC_ALL": "x"}, {"TERM": ""}, {"TZ": "x"}, {"PATH": ""}, {"NO_COLOR": "\x1b"},
)  # fmt: skip


def options(count: int) -> Iterator[Trial]:
    """Each option of each command with each value, as many as are drawn from a fixed seed."""
    from scarid_cli.cli import scarid

    context = click.Context(scarid)
    pairs = [(name, max(parameter.opts, key=len), value)
             for name in COMMANDS
             for parameter in (scarid.get_command(context, name) or click.Command("")).params
             if isinstance(parameter, click.Option) and not parameter.is_flag
             for value in VALUES]  # fmt: skip
    rng, folder = np.random.default_rng(3), folder_of(files())
    for i in rng.permutation(len(pairs))[:count]:
        name, option, value = pairs[i]
        words = (name, *INPUTS.get(name, ("log.parquet",)), f"{option}={value}")
        yield Trial(f"{option}={value[:20]!r}", words, folder)
        for extra in {path.name for path in folder.iterdir()} - files().keys():
            (folder / extra).unlink() if (folder / extra).is_file() else None
    removed(folder)


def environments() -> Iterator[Trial]:
    """Commands under environments with broken values."""
    folder = folder_of(files())
    for environment in ENVIRONMENTS:
        for words in (
            ("filter", "log.parquet"),
            ("identify", "log.csv"),
            ("info", "log.arrow"),
            ("--help",),
        ):
            yield Trial(
                str(environment), words, folder, before=lambda e=environment: os.environ.update(e)
            )  # type: ignore[misc]
    removed(folder)
