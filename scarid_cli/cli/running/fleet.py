"""`scarid report --fleet`: the outcome of a batch in words and as a page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from scarid_cli.cli.running.documents import Documents
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io.table import Table
from scarid_cli.reporting.fleet import FleetRobot, fleet
from scarid_cli.reporting.fleet_history import histories
from scarid_cli.reporting.fleet_sections import sections


def of_fleet(
    job: Job,
    folder: str,
    title: str,
    html: str | None,
    markdown: str | None,
    place: str | None,
) -> None:
    """Print the robots and the logs that need a look, and write the documents."""
    documents = Documents.opened(job, html, markdown, place)
    robots = _read(job, Path(folder))
    if page := documents.page:
        page.write(_page(title, robots, folder, page.path))
    documents.write(title, sections(robots))


def _page(title: str, robots: Sequence[FleetRobot], folder: str, path: str) -> str:
    """The page that goes to this path, from which its links lead to the folder."""
    from scarid_cli.reporting import fleet_page

    base = os.path.relpath(folder, "." if path == "-" else Path(path).parent)
    tsv = Path(folder, "fleet.tsv").is_file()
    return fleet_page.html(title, robots, base.replace(os.sep, "/"), tsv=tsv)


def _read(job: Job, folder: Path) -> tuple[FleetRobot, ...]:
    """The three tables of a batch."""
    missing = next((name for name in TABLES if not (folder / name).is_file()), None)
    if missing:
        raise UsageFault(
            f"{folder}: no {missing} in it; give the folder of a batch's outcome (docs/batch.md)"
        )
    logs, estimates, robots = (
        job.read(str(folder / name), name.removesuffix(".parquet")) for name in TABLES
    )
    rows = _rows(logs)
    if not rows:
        raise bad_data(logs.name, "no rows", expected="a row for each log", remedy="run the batch")
    return fleet(_rows(robots), rows, histories(estimates))


TABLES = ("fleet.parquet", "estimates.parquet", "robots.parquet")


def _rows(table: Table) -> list[dict[str, Any]]:
    return [row for batch in table.batches for row in batch.to_pylist()]
