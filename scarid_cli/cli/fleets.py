"""Run `scarid report --fleet`."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from scarid_cli.cli.command_line import was_given
from scarid_cli.cli.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.reporting import text
from scarid_cli.reporting.fleet.reading import fleet as fleet_of
from scarid_cli.reporting.fleet.summary import sections

TABLES = ("fleet", "estimates", "robots")
TITLE = "Fleet report"


def report(
    job: Job, folder: str, *, html: str | None, markdown: str | None, place: str | None, title: str
) -> None:
    """Print what a batch found, and write the documents."""
    paths = [str(Path(folder) / f"{name}.parquet") for name in TABLES]
    _require_all(paths)
    page, plain, printed = (job.side_text(path) for path in (html, markdown, place))
    tables = (job.read(path, kind) for path, kind in zip(paths, TABLES, strict=True))
    found = fleet_of(*tables)
    title = title if was_given("title") else TITLE
    shown = sections(found)
    if page:
        from scarid_cli.reporting.fleet import page as rendering  # jinja2 takes a tenth of a second

        page.write(rendering.page(title, found, _way(folder, html)))
    if plain:
        plain.write(text.markdown(title, shown))
    if printed:
        printed.write(text.terminal(shown, plain=True))
    elif "-" not in (html, markdown):
        sys.stdout.write(text.terminal(shown))
        sys.stdout.flush()


def _require_all(paths: list[str]) -> None:
    missing = next((path for path in paths if not Path(path).is_file()), None)
    if missing:
        raise UsageFault(f"{missing}: no such file; --fleet takes the folder of a batch's outcome")


def _way(folder: str, page: str | None) -> str:
    """The way from the place of the page to the folder; a page in a pipe is taken to be in it."""
    if page in (None, "-"):
        return ""
    way = os.path.relpath(folder, Path(page or "").parent)
    return "" if way == "." else f"{Path(way).as_posix()}/"
