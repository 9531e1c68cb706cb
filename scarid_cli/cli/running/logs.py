"""The logs of a command that takes several as one record."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

from scarid_cli.cli.running.robots import another
from scarid_cli.errors import BadData, UsageFault
from scarid_cli.io.table import Table

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot
    from scarid_cli.cli.running.job import Job

Reading = Callable[[str, "str | Robot | None"], "tuple[Table, Robot]"]


def read_logs(
    job: Job, files: Sequence[str], robot: str | None, reading: Reading, *, skip: object = None
) -> tuple[list[Table], Robot]:
    """The logs, and their robot, which is that of the first log if none is given.

    Each is opened by `reading`, given its path and the robot; without files, this is standard
    input. `skip` is what was given to --skip.
    """
    first, arm = reading(files[0] if files else "-", robot)
    if len(files) < 2:
        return [first], arm
    if skip:
        raise UsageFault("--skip counts the rows of one log; choose rows of each with --rows")
    _require_different(files)
    tables = [first, *(reading(file, arm)[0] for file in files[1:])]
    if remark := another(arm, tables[1:]):
        if not robot:
            raise BadData(
                f"{remark.removeprefix('warning: ')}; give logs of one robot, or state it with "
                "--robot"
            )
        job.notes.append(remark)
    found = [float(table.meta.extra.get("bandwidth") or 0.0) for table in tables]
    if 0.0 < min(found) < max(found):
        job.notes.append(
            f"the bandwidths of the motions differ, from {min(found):.3g} to {max(found):.3g} Hz; "
            "the rows are chosen by the lowest one"
        )
    return tables, arm


def _require_different(files: Sequence[str]) -> None:
    """Refuse a log that is given twice: its rows would count as new information."""
    for one, other in combinations(files, 2):
        if one == other or os.path.samestat(_found(one), _found(other)):
            raise UsageFault(f"{other}: the log is given twice; give each one once")


def _found(file: str) -> os.stat_result:
    """What tells files apart; of standard input, the file that it was redirected from."""
    return os.fstat(0) if file == "-" else os.stat(file)  # noqa: PTH116 (pathlib takes a while)
