"""A report as one self-contained HTML page: no network and no other file."""

from __future__ import annotations

import logging
import re
from collections.abc import Sequence
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup

from scarid_cli import __version__
from scarid_cli.io.table import Table
from scarid_cli.reporting import svg
from scarid_cli.reporting.answer import Answer
from scarid_cli.reporting.curves import POINTS
from scarid_cli.reporting.origins import origins
from scarid_cli.reporting.parts import Section, header_lines

NO_BREAK = "\N{NO-BREAK SPACE}"


def figures(sections: Sequence[Section]) -> list[list[str]]:
    """Every plot of every section as an SVG document."""
    # While it is imported, matplotlib may log messages about its caches.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    from scarid_cli.reporting.figures import drawn

    return drawn(sections)


def html(
    title: str,
    answer: Answer | None,
    sections: Sequence[Section],
    drawn: list[list[str]],
    tables: Sequence[Table],
) -> str:
    """The whole page with its figures; it ends with the history of the `tables`."""
    from scarid_cli.reporting.figures import element

    return _template().render(
        title=title,
        version=__version__,
        points=POINTS,
        count=len(tables),
        no_break=NO_BREAK,
        answer=answer,
        origins=origins(tables),
        colours=Markup(_colours()),
        sections=[
            {
                "section": section,
                "anchor": anchor,
                "figures": [
                    (plot.caption, _own(element(document), f"f{i}-{j}-"))
                    for j, (plot, document) in enumerate(
                        zip(section.plots, documents, strict=True), 1
                    )
                ],
            }
            for i, (section, anchor, documents) in enumerate(
                zip(sections, anchors([s.title for s in sections]), drawn, strict=True), 1
            )
        ],
    )


def anchors(titles: Sequence[str]) -> list[str]:
    """An identifier for each title; equal ones are numbered."""
    found: list[str] = []
    for title in titles:
        name = "-".join(["s", *re.findall(r"[a-z0-9]+", title.lower())])
        found.append(name if name not in found else f"{name}-{len(found)}")
    return found


def _colours() -> str:
    """The colours of the methods on a light and on a dark page, and in print."""
    dark = f"@media screen and (prefers-color-scheme:dark){{:root{{{svg.variables(1)}}}}}"
    return f":root{{{svg.variables(0)}}}{dark}{svg.classes()}"


def _template() -> Template:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["wrapping"] = _wrapping
    environment.filters["markup"] = Markup
    return environment.get_template("report.html")


def _wrapping(header: str) -> str:
    """The header with spaces that a browser may break at between its lines only."""
    return " ".join(line.replace(" ", NO_BREAK) for line in header_lines(header))


def _own(svg: str, prefix: str) -> Markup:
    """The figure with a prefix before its identifiers: those of a page must be unique."""
    return Markup(re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}", svg))
