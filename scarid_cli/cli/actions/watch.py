"""Run `scarid watch`."""

from __future__ import annotations

from typing import Any

from scarid_cli.cli.actions import identify
from scarid_cli.cli.running.board import Board
from scarid_cli.cli.running.job import Job

# What `identify` has beside, as if it were not given.
REST: dict[str, Any] = {
    "variance": "residual",
    "as_json": False,
    "estimator": "rls",
    "settings": (),
    "p0": None,
    "align": False,
    "essential": False,
    "friction": "described",
    "consistent": False,
    "resumed": None,
    "gains": None,
    "free_gains": None,
    "torque_gain_error": None,
    "save": None,
    "from_time": None,
    "to_time": None,
    "rows": None,
    "missing": None,
}


def run(job: Job, *, every: float, **given: Any) -> int:
    """Show what is known so far, then write the parameters; returns the exit status."""
    board = Board(every)
    with board.shown(quiet=job.quiet):
        return identify.shown(job, board, **REST, **given)
