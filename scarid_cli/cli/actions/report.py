"""Run `scarid report`."""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

from scarid_cli.cli.running.documents import Documents
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Table
from scarid_cli.reporting import naming, results
from scarid_cli.reporting import published as values_of
from scarid_cli.reporting import repeated as repetitions
from scarid_cli.reporting.content import sections
from scarid_cli.reporting.kinds import Result
from scarid_cli.reporting.parts import Section


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    html: str | None,
    markdown: str | None,
    published: str | None,
    repeated: bool,
    fleet: str | None,
    figures: str | None,
    title: str | None,
    place: str | None,
) -> None:
    """Print the tables, and write the documents."""
    if fleet:
        from scarid_cli.cli.running.fleet import of_fleet

        others = {"--repeated": repeated, "--published": published, "--figures": figures}
        _require_alone(files, others)
        of_fleet(job, fleet, title or "Fleet report", html, markdown, place)
        return
    paths = files or ("-",)
    _require_distinct(paths)
    documents = Documents.opened(job, html, markdown, place)
    tables = _reportable(job, paths)
    values = values_of.read(job.read(published, "published")) if published else None
    collected = results.collect(tables, repeated=repeated)
    title = title or _title(collected, tables)
    found = (repetitions.sections if repeated else sections)(collected, values)
    if figures:
        _save(job, Path(figures), found)
    if documents.page:
        from scarid_cli.reporting.study import page as rendering  # jinja2 takes a tenth of a second

        documents.page.write(
            rendering.repeated(title, collected, values, tables)
            if repeated
            else rendering.study(title, collected, values, tables)
        )
    documents.write(title, found)
    if not html and any(not section.rows for section in found):
        job.say("some tables have figures only; draw them with --html FILE")


def _title(found: Sequence[Result], tables: Sequence[Table]) -> str:
    """The title of a report, with its robots, whether their descriptions are found or not."""
    robots = dict.fromkeys(r.robot_name for r in found if r.robot_name)
    robots = robots or dict.fromkeys(t.meta.robot for t in tables if t.meta.robot)
    return f"Identification of {', '.join(robots)}" if robots else "Identification report"


def _reportable(job: Job, paths: Sequence[str]) -> list[Table]:
    """The tables; of several, those that have no place in a report are skipped with a note."""
    tables, skipped = [], []
    for path in paths:
        try:
            tables.append(results.reportable(job.read(path, None)))
        except results.NotReported as reason:
            skipped.append(reason)
    if not tables:
        raise skipped[0]
    job.notes += [f"skipped: {reason}" for reason in skipped]
    return tables


def _require_alone(files: Sequence[str], others: Mapping[str, object]) -> None:
    """Refuse what a report of a fleet has no use for."""
    if files:
        raise UsageFault(f"--fleet reads its own folder; leave {files[0]} out")
    if given := next((option for option, value in others.items() if value), None):
        raise UsageFault(f"{given} has no meaning with --fleet; leave it out")


def _require_distinct(paths: Sequence[str]) -> None:
    twice = next((path for path, count in Counter(paths).items() if count > 1), None)
    if twice:
        raise UsageFault(f"{twice} is given twice; each table can be read once")


def _save(job: Job, folder: Path, found: list[Section]) -> None:
    """Write each figure as a file of its own."""
    # While it is imported, which takes half a second, matplotlib may log messages on its caches.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    from scarid_cli.reporting.figures import drawn

    for name, document in naming.figures([section.title for section in found], drawn(found)):
        job.figure(str(folder / name)).write(document)
