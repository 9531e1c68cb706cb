"""What a chapter of the page is made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from markupsafe import Markup

from scarid_cli.reporting.parts import Section
from scarid_cli.reporting.study.chart import Chart, drawn, times


@dataclass(frozen=True)
class Key:
    """An entry of a legend: the class of a colour, and whether its curves are shown at first."""

    name: str
    style: str
    off: bool = False


@dataclass(frozen=True)
class Figure:
    """Panels under a caption; with `zoom` those over time can be enlarged."""

    caption: str
    panels: tuple[Markup, ...]
    keys: tuple[Key, ...] = ()
    zoom: bool = False
    wide: bool = False
    kind: str = field(default="figure", init=False)


@dataclass(frozen=True)
class Matrix:
    """Methods across, parameters down; each cell is a text, a remark below it and a class."""

    headers: tuple[tuple[str, str], ...]
    keys: tuple[str, ...]
    rows: tuple[tuple[tuple[str, ...], tuple[tuple[str, str, str], ...]], ...]
    kind: str = field(default="matrix", init=False)


@dataclass(frozen=True)
class Grid:
    """A table of a section, as the terminal shows it."""

    section: Section
    kind: str = field(default="grid", init=False)


@dataclass(frozen=True)
class Methods:
    """One row a method: name, colour class, verdict, first reason, other reasons."""

    rows: tuple[tuple[str, str, str, str, tuple[str, ...]], ...]
    kind: str = field(default="methods", init=False)


@dataclass(frozen=True)
class Fold:
    """Blocks behind a summary, shown on demand."""

    summary: str
    blocks: tuple[Block, ...]
    kind: str = field(default="fold", init=False)


Block = Figure | Matrix | Grid | Methods | Fold


@dataclass(frozen=True)
class Chapter:
    """A part of the page with an entry in its contents; `words` are explained at its head."""

    title: str
    short: str
    note: str
    words: tuple[str, ...]
    blocks: tuple[Block, ...]


def figure(
    caption: str, charts: Sequence[Chart], keys: Sequence[Key] = (), *, wide: bool = False
) -> Figure:
    """Panels over the same time."""
    between = times(charts)
    panels = tuple(drawn(chart, between) for chart in charts)
    return Figure(caption, panels, tuple(keys), zoom=True, wide=wide)
