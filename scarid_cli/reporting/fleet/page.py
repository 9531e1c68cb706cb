"""The page of a fleet: one self-contained HTML document, without any network."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from scarid_cli import __version__
from scarid_cli.reporting.fleet.cards import cards
from scarid_cli.reporting.fleet.entries import HEADERS, entries, script_data
from scarid_cli.reporting.fleet.reading import STATES, Fleet
from scarid_cli.reporting.fleet.summary import counts, headline

FOLDER = Path(__file__).parent
BASE = FOLDER.parent / "study" / "study.css"
FIRST = 100  # rows that stand in the document itself, and on a page of the table


def page(title: str, fleet: Fleet, prefix: str) -> str:
    """The page; `prefix` leads from its place to the folder of the batch ("" or ending in /)."""
    found = entries(fleet, prefix)
    environment = Environment(
        loader=FileSystemLoader(FOLDER),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    return environment.get_template("fleet.html").render(
        title=title,
        version=__version__,
        headline=headline(fleet),
        counts=counts(fleet),
        states=STATES,
        cards=cards(fleet),
        headers=HEADERS,
        entries=found[:FIRST],
        count=len(found),
        prefix=prefix,
        data=Markup(script_data(found)),
        style=Markup("\n".join(_read(p) for p in (BASE, FOLDER / "fleet.css"))),
        script=Markup(_read(FOLDER / "fleet.js")),
    )


def _read(path: Path) -> str:
    return path.read_text("utf-8")
