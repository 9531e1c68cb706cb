"""A report as text: on a terminal, in a pipe, and as Markdown."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace

from rich.box import Box
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table

from scarid_cli.printable import printable
from scarid_cli.reporting.parts import GAP, Section, split

TEXT_WIDTH = 100  # characters of running text where there is no terminal
TABLE_WIDTH = 120  # and of a table, which is shown in parts if it is wider

# What Markdown interprets: marks, the end of a link's text, entities, _ at the edge of a word, and
# the # that ends a heading.
MARKS = re.compile(r"[\\|*<`~$]|\](?=[(\[:])|&(?=[#\w])|(?<![^\W_])_|_(?![^\W_])|(?<!\S)#")

# One line, under the headers; rich writes it in ASCII where the terminal needs that.
RULE = Box("\n".join(["    "] * 2 + [" ── "] + ["    "] * 5) + "\n")


def terminal(sections: Sequence[Section], *, plain: bool = False) -> str:
    """Tables for standard output; those that are too wide are shown in parts.

    `plain` tables are for a file.
    """
    at_window = False if plain else None  # None: if standard output is one
    console = Console(markup=False, emoji=False, highlight=False, force_terminal=at_window)
    width = console.width if console.is_terminal else TEXT_WIDTH
    with console.capture() as capture:
        for section in _with_rows(sections):
            console.width = width
            console.print(section.title, style="bold")
            if section.note:
                console.print(section.note, style="dim")
            for part in _parts(section, width if console.is_terminal else TABLE_WIDTH):
                # A part that is still too wide keeps its width: no number is cut.
                console.width = width if part.prose else max(width, sum(_widths(part)))
                console.print(_table(part))
                console.print()
    # A name with characters that the terminal cannot show must not end the report.
    text = capture.get().encode(console.encoding, "replace").decode(console.encoding)
    return text if console.is_terminal else _stripped(text)


def _parts(section: Section, width: int) -> list[Section]:
    """The parts of a table that are not too wide; running text is wrapped in its column."""
    return [section] if section.prose else split(section, width)


def _with_rows(sections: Sequence[Section]) -> Iterator[Section]:
    """The sections that have a table, which a terminal can show."""
    for section in sections:
        if section.rows:
            yield replace(
                section,
                title=printable(section.title),
                note=printable(section.note),
                headers=tuple(map(printable, section.headers)),
                rows=tuple(tuple(map(printable, row)) for row in section.rows),
            )


def _widths(section: Section) -> list[int]:
    columns = zip(section.headers, *section.rows, strict=True)
    return [max(map(cell_len, column)) + GAP for column in columns]


def _table(section: Section) -> Table:
    table = Table(box=RULE, show_edge=False, padding=(0, GAP - 1, 0, 0), pad_edge=False)
    for index, header in enumerate(section.headers):
        left = index < section.texts
        prose = section.prose and index == len(section.headers) - 1
        table.add_column(header, justify="left" if left else "right", no_wrap=not prose)
    for row in section.rows:
        table.add_row(*row)
    return table


def _stripped(text: str) -> str:
    return "".join(f"{line.rstrip()}\n" for line in text.rstrip().splitlines())


def markdown(title: str, sections: Sequence[Section]) -> str:
    """Tables in GitHub-flavoured Markdown, aligned so that the source is readable too."""
    parts = [f"# {_escaped(printable(title))}\n"]
    for section in _with_rows(sections):
        parts.append(f"## {_escaped(section.title)}\n")
        if section.note:
            parts.append(f"{textwrap.fill(_escaped(section.note), TEXT_WIDTH)}\n")
        parts.append(_markdown_table(section))
    return "\n".join(parts)


def _markdown_table(section: Section) -> str:
    rows = [[_escaped(cell) for cell in row] for row in (section.headers, *section.rows)]
    widths = [max(3, *map(len, column)) for column in zip(*rows, strict=True)]
    left = [index < section.texts for index in range(len(widths))]
    rule = ["-" * w if text else "-" * (w - 1) + ":" for w, text in zip(widths, left, strict=True)]
    padded = [
        [c.ljust(w) if text else c.rjust(w) for c, w, text in zip(row, widths, left, strict=True)]
        for row in rows
    ]
    lines = [padded[0], rule, *padded[1:]]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _escaped(text: str) -> str:
    """The text with a backslash before each character that Markdown would interpret."""
    return MARKS.sub(r"\\\g<0>", text)
