"""Where the steps of a batch leave what they make."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from steps.plan import Log, Plan, Robot

MADE = {
    "identify": ("check.json", "parameters.parquet"),
    "validate": ("metrics.parquet", "prediction.parquet", "report.html"),
}


def folder_of(plan: Plan, robot: Robot, log: Log) -> Path:
    """The folder of a log's own tables."""
    return plan.out / "logs" / robot.name / log.name


def cleared(plan: Plan, robot: Robot, log: Log, step: str) -> Path:
    """The folder of a log, without what an earlier run of this step left there."""
    folder = folder_of(plan, robot, log)
    folder.mkdir(parents=True, exist_ok=True)
    for name in MADE[step]:
        (folder / name).unlink(missing_ok=True)
        for part in folder.glob(f".{name}.*"):
            part.unlink()
    return folder


def swept(folder: Path) -> None:
    """Remove what commands that were killed left in a folder."""
    for pattern in (".*.part", ".*.before"):
        for part in folder.glob(pattern):
            part.unlink(missing_ok=True)


def description(robot: Robot) -> Iterator[str | Path]:
    """The name of the robot's description, and the file if it is one."""
    yield robot.description
    if (file := Path(robot.description)).is_file():
        yield file


def work(plan: Plan, robot: Robot, group: str, what: str) -> Path:
    """The folder of a group's tables of one kind, which do not stay."""
    return plan.out / "jobs" / robot.name / f"{group}.{what}"


def table(folder: Path, log: Log) -> Path:
    """A log's table in such a folder."""
    path = folder / f"{log.name}.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def columns(path: Path) -> pa.Table:
    """A table that a command wrote; `pyarrow.parquet.read_table` would import twice as much."""
    # pyarrow takes a path only if it is UTF-8.
    with path.open("rb") as source, pq.ParquetFile(source) as file:
        return file.read(use_threads=False)


def results(plan: Plan, robot: Robot, step: str, group: str = "") -> Path:
    """The results of a step, as JSON: a list with an entry for each log, or one entry."""
    return plan.out / "jobs" / robot.name / f"{group + '.' if group else ''}{step}.json"


def write(path: Path, found: Any) -> None:
    """Write results; they appear when they are complete."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(found, indent=1, sort_keys=True) + "\n", "utf-8")
    part.replace(path)


def read(path: Path) -> Any:
    """Read results."""
    return json.loads(path.read_text("utf-8"))
