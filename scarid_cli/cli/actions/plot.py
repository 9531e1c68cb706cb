"""Run `scarid plot`."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import click

from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.remedies import remedies
from scarid_cli.cli.running.terminal import coloured, columns_of
from scarid_cli.errors import UsageFault
from scarid_cli.io.clock import clocked
from scarid_cli.io.table import Table
from scarid_cli.reporting.parts import Panels, Ranges
from scarid_cli.reporting.plotting.content import content
from scarid_cli.reporting.plotting.terminal import Screen, lines

PICTURES = (".svg", ".png")


def run(job: Job, *, file: str, columns: str | None, spectrum: bool, place: str | None) -> None:
    """Draw the table."""
    if place and Path(place).suffix.lower() not in PICTURES:
        raise UsageFault(f"{place}: give the picture the extension {' or '.join(PICTURES)}")
    picture = job.side_text(place)
    table = job.within(job.read(file, None))
    regular = partial(_regular, file) if spectrum else None
    plot = content(table, _names(columns), regular)
    if picture:
        picture.write(_drawn(plot, Path(picture.path).suffix.lower()))
    else:
        for line in lines(plot, Screen(columns_of(1), coloured())):
            click.echo(line)


def _names(columns: str | None) -> Sequence[str]:
    return [name.strip() for name in columns.split(",") if name.strip()] if columns else []


def _regular(path: str, table: Table) -> Table:
    """The table, with its period; a clock that is not regular is refused."""
    return clocked(table, regular=True, remedy=remedies(path, regular=True).clock)


def _drawn(plot: Panels | Ranges, extension: str) -> str | bytes:
    # While it is imported, which takes half a second, matplotlib may log messages on its caches.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    from scarid_cli.reporting import figures, shades

    return (
        figures.png(plot)
        if extension == ".png"
        else shades.both(figures.draw(plot, captioned=True))
    )
