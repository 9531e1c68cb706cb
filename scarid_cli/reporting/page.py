"""A report as one self-contained HTML page: no network, no script, no other file."""

from __future__ import annotations

import logging
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined, Template
from markupsafe import Markup

from scarid_cli import __version__
from scarid_cli.io.table import Table
from scarid_cli.reporting.curves import POINTS
from scarid_cli.reporting.parts import Section, header_lines, split

PAGE_WIDTH = 108  # characters of a table that fit an A4 page

NO_BREAK = "\N{NO-BREAK SPACE}"


def figures(sections: Sequence[Section]) -> list[list[str]]:
    """Every plot of every section as an SVG document."""
    # While it is imported, matplotlib may log messages about its caches.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    from scarid_cli.reporting.figures import drawn

    return drawn(sections)


def html(
    title: str, sections: Sequence[Section], drawn: list[list[str]], tables: Sequence[Table]
) -> str:
    """The whole page with its figures; it ends with the history of the `tables`."""
    from scarid_cli.reporting.figures import element

    return _template().render(
        title=title,
        version=__version__,
        points=POINTS,
        count=len(tables),
        no_break=NO_BREAK,
        origins=_origins(tables),
        sections=[
            {
                "section": section,
                "parts": split(section, PAGE_WIDTH, wrapped=True) if section.rows else [],
                "figures": [
                    (plot.caption, _own(element(document), f"f{i}-{j}-"))
                    for j, (plot, document) in enumerate(
                        zip(section.plots, documents, strict=True), 1
                    )
                ],
            }
            for i, (section, documents) in enumerate(zip(sections, drawn, strict=True), 1)
        ],
    )


def _template() -> Template:
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters["wrapping"] = _wrapping
    return environment.get_template("report.html")


def _origins(tables: Sequence[Table]) -> list[dict[str, Any]]:
    """Tables of one run share a history, which is listed once."""
    origins: list[dict[str, Any]] = []
    for table in tables:
        same = next((o for o in origins if o["history"] == table.meta.history), None)
        if same:
            same["names"].append(table.name)
        else:
            origins.append({"names": [table.name], "history": table.meta.history})
    return origins


def _wrapping(header: str) -> str:
    """The header with spaces that a browser may break at between its lines only."""
    return " ".join(line.replace(" ", NO_BREAK) for line in header_lines(header))


def _own(svg: str, prefix: str) -> Markup:
    """The figure with a prefix before its identifiers: those of a page must be unique."""
    return Markup(re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{prefix}", svg))
