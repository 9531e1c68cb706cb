"""Where each page of the site stands. A new page of `docs/` is added to a line here, once.

An entry is the name of a page below `docs/`, or a pattern of names: in its place stand all pages
that match and that no entry names. A pattern may match nothing.
"""

from __future__ import annotations

from fnmatch import fnmatchcase
from pathlib import Path

Navigation = dict[str, list[str]]

SECTIONS: Navigation = {
    "Tutorials": [
        "your-robot-from-bag-to-urdf.md",
        "from-a-bag-to-mujoco.md",
        "beside-the-robot.md",
        "batch.md",
        "tutorials/*.md",
    ],
    "How-to": [
        "howto/describe-a-robot.md",
        "howto/plan-an-experiment.md",
        "howto/choose-a-soft-sensor.md",
        "howto/read-a-verdict.md",
        "howto/state-a-motor-constant.md",
        "howto/find-a-payload.md",
        "howto/find-a-pick-up.md",
        "howto/gate-a-ci-job.md",
        "howto/*.md",
        "real-logs.md",
        "clocks-and-recordings.md",
        "python.md",
    ],
    "Reference": [
        "reference/commands/*.md",
        "reference/methods.md",
        "reference/exit-statuses.md",
        "pipes.md",
        "tables.md",
        "beyond.md",
        "formats.md",
        "robots.md",
        "simulator.md",
        "check.md",
        "known-faults.md",
        "report.md",
        "reference/*.md",
    ],
    "Explanation": [
        "soft-sensors.md",
        "estimators.md",
        "errors.md",
        "excitation.md",
        "validation.md",
        "contacts-and-loads.md",
        "theory*.md",
        "theory/*.md",
        "explanation/*.md",
        "paper.md",
        "real-robots.md",
        "real-robots-in-detail.md",
        "verdict.md",
        "gauntlet.md",
        "gauntlet/*.md",
        "faults.md",
        "speed.md",
    ],
    "Project": [
        "compatibility*.md",
        "repository/CONTRIBUTING.md",
        "adding.md",
        "repository/CHANGELOG.md",
        "repository/DESIGN.md",
        "design/*.md",
        "repository/*.md",
    ],
}
# The start page, in no section.
INDEX = "index.md"


def pages(docs: Path) -> list[str]:
    """The pages of a folder, by name, in order."""
    return sorted(path.relative_to(docs).as_posix() for path in docs.rglob("*.md"))


def navigation(there: list[str]) -> Navigation:
    """The pages of each section in order, of those that are there."""
    named = {entry for entries in SECTIONS.values() for entry in entries if "*" not in entry}
    return {
        title: [page for entry in entries for page in _meant(entry, there, named)]
        for title, entries in SECTIONS.items()
    }


def _meant(entry: str, there: list[str], named: set[str]) -> list[str]:
    """The pages that an entry stands for; a name of no page is kept, for MkDocs to complain."""
    if "*" not in entry:
        return [entry]
    free = (page for page in there if page not in named)
    return [p for p in free if fnmatchcase(p, entry) and p.count("/") == entry.count("/")]


def lost(there: list[str]) -> list[str]:
    """The pages that stand nowhere."""
    placed = {page for section in navigation(there).values() for page in section}
    return [page for page in there if page != INDEX and page not in placed]
