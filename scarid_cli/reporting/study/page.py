"""A report as one self-contained HTML page: no network and no other file."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from jinja2 import Template
from markupsafe import Markup

from scarid_cli import __version__
from scarid_cli.io.table import Table
from scarid_cli.reporting import published
from scarid_cli.reporting.curves import POINTS
from scarid_cli.reporting.estimates import said_of
from scarid_cli.reporting.kinds import Measurement, Result
from scarid_cli.reporting.parts import Section, header_lines, split
from scarid_cli.reporting.repeated import sections as repeated_sections
from scarid_cli.reporting.study import repetitions
from scarid_cli.reporting.study.blocks import Chapter
from scarid_cli.reporting.study.chapters import chapters, of_sections, view_of
from scarid_cli.reporting.study.colours import rules
from scarid_cli.reporting.study.opening import Opening, opening
from scarid_cli.reporting.study.origin import origin
from scarid_cli.reporting.study.terms import Glossary
from scarid_cli.reporting.templates import templates

PAGE_WIDTH = 108  # characters of a table that fit an A4 page
NO_BREAK = "\N{NO-BREAK SPACE}"
FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Titled:
    """A chapter with its anchor and the words that are explained at its head."""

    anchor: str
    chapter: Chapter
    words: tuple[tuple[str, str], ...]


def study(
    title: str, results: Sequence[Result], values: published.Values | None, tables: Sequence[Table]
) -> str:
    """The page of these results."""
    view = view_of(results)
    first = opening(view.ranking, view.colours, said_of(results)) if view.ranking else None
    logs = sum(isinstance(result, Measurement) for result in results)
    found = chapters(view, results, values)
    return _rendered(title, first, found, tables, rules(len(view.colours) + logs))


def repeated(
    title: str, results: Sequence[Result], values: published.Values | None, tables: Sequence[Table]
) -> str:
    """The page of experiments that were repeated, whose chapters are tables, the best first."""
    found = repetitions.ranked(results)
    first = repetitions.opening(found) if found.methods else None
    sections = repeated_sections(found.in_order(results), values)
    return _rendered(title, first, of_sections(sections), tables, rules(len(found.methods)))


def _rendered(
    title: str,
    first: Opening | None,
    found: Iterator[Chapter],
    tables: Sequence[Table],
    colours: str,
) -> str:
    return _template().render(
        title=title,
        version=__version__,
        points=POINTS,
        count=len(tables),
        opening=first,
        chapters=_titled(found),
        origin=origin(tables),
        colours=Markup(colours),
        style=Markup((FOLDER / "study.css").read_text("utf-8")),
        script=Markup((FOLDER / "study.js").read_text("utf-8")),
    )


def _titled(found: Iterator[Chapter]) -> list[Titled]:
    """The chapters with anchors that are unique, and each word explained once."""
    glossary, anchors = Glossary(), set[str]()
    titled = []
    for chapter in found:
        stem = "-".join(re.findall(r"[a-z0-9]+", chapter.title.lower())) or "chapter"
        names = (f"{stem}-{k}" if k else stem for k in range(len(anchors) + 1))
        anchor = next(name for name in names if name not in anchors)
        anchors.add(anchor)
        titled.append(Titled(anchor, chapter, glossary.explain(chapter.words)))
    return titled


def _template() -> Template:
    environment = templates(FOLDER)
    environment.filters["wrapping"] = _wrapping
    environment.filters["parts"] = _parts
    return environment.get_template("study.html")


def _parts(section: Section) -> list[Section]:
    return split(section, PAGE_WIDTH, wrapped=True)


def _wrapping(header: str) -> str:
    """The header with spaces that a browser may break at between its lines only."""
    return " ".join(line.replace(" ", NO_BREAK) for line in header_lines(header))
