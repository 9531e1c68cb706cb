"""A page in the language of man pages (man(7)), as mandoc and groff read it."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Iterable, Iterator
from datetime import date

from scarid_cli import __version__
from scarid_cli.cli.manual.common import Entries
from scarid_cli.cli.manual.pages import Page, Paragraph, Section

WIDTH = 78  # of the lines of the source


def rendered(page: Page, day: date) -> str:
    """The text of a file such as scarid-identify.1."""
    head = f'.TH {page.name.upper()} 1 {day.isoformat()} "scarid {__version__}" "scarid"'
    lines = [head, ".SH NAME", f"{_escaped(page.name)} \\- {_escaped(page.summary)}"]
    lines += [".SH SYNOPSIS", _text(f"`{' '.join(page.words)}` {page.usage}")]
    lines += _heading("DESCRIPTION", _paragraphs(page.text))
    lines += _heading("OPTIONS", _sections(page.options))
    lines += _more(page.more)
    lines += _heading("EXIT STATUS", _list(page.statuses))
    lines += _heading("FILES", _list(page.files))
    lines += _heading("ENVIRONMENT", _list(page.environment))
    lines += _heading("EXAMPLES", _paragraphs(page.examples))
    names = [f"\\fB{_escaped('-'.join(words))}\\fR(1)" for words in page.also]
    lines += _heading("SEE ALSO", [",\n".join(names)])
    return "\n".join(lines) + "\n"


def _heading(title: str, content: Iterable[str]) -> list[str]:
    """A section, unless it is empty."""
    lines = list(content)
    return [f".SH {_argument(title)}", *lines] if lines else []


def _paragraphs(paragraphs: Iterable[Paragraph]) -> Iterator[str]:
    for number, paragraph in enumerate(paragraphs):
        if number:
            yield ".PP"
        if paragraph.verbatim:
            yield from (".RS 4", ".nf")
            yield from map(_line, paragraph.text.splitlines())
            yield from (".fi", ".RE")
        else:
            yield _text(paragraph.text)


def _sections(sections: list[Section]) -> Iterator[str]:
    for section in sections:
        if len(sections) > 1:
            yield f".SS {_argument(section.title)}"
        yield from _list(section.entries)


def _more(sections: list[Section]) -> Iterator[str]:
    """Sections of their own, those below a heading without entries as parts of it."""
    macro = ".SH"
    for section in sections:
        title = re.split(r"[,(]", section.title)[0].strip()
        yield f"{macro} {_argument(title.upper() if macro == '.SH' else title)}"
        yield from _list(section.entries)
        macro = macro if section.entries else ".SS"


def _list(entries: Entries) -> Iterator[str]:
    for term, text in entries:
        yield ".TP"
        yield f"\\fB{_escaped(term)}\\fR"
        yield _text(text)


def _text(text: str) -> str:
    """Text to be wrapped; words in backticks become bold."""
    words = _escaped(" ".join(text.split()))
    bold = re.sub(r"`([^`]+)`", r"\\fB\1\\fR", words)
    return "\n".join(
        map(_safe, textwrap.wrap(bold, WIDTH, break_long_words=False, break_on_hyphens=False))
    )


def _line(line: str) -> str:
    """A line as it stands; an empty one would be a warning."""
    return _safe(_escaped(line)) if line.strip() else ".sp"


def _escaped(text: str) -> str:
    """Characters that mean something else: the backslash, and the hyphen that is a minus."""
    return text.replace("\\", "\\e").replace("-", "\\-").replace("^", "\\(ha").replace("~", "\\(ti")


def _safe(line: str) -> str:
    """A line that does not begin like a request."""
    return f"\\&{line}" if line.startswith((".", "'")) else line


def _argument(title: str) -> str:
    return f'"{_escaped(title)}"'
