"""Pages are written for GitHub; this puts them as Python-Markdown reads them alike.

Python-Markdown wants four spaces before what belongs to an item of a list, where GitHub is content
with two; an empty line between an item's second paragraph and the next item; and one word beside
the fence of a code block. What a command prints is marked: nobody copies it, and messages, which
are long, are wrapped.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import takewhile

ITEM = re.compile(r" *(?:[-*]|\d+\.) ")
FENCE = re.compile(r"( *)```(\w*)")
MESSAGE = re.compile(r" *scarid( \w+)*: ")
SHORT = 45  # characters: what fits on a telephone, and is not broken by wrapping


def adapted(text: str) -> str:
    """The text, with the indentation and the fences that Python-Markdown knows."""
    return "\n".join(_lines(text.split("\n")))


def _lines(lines: list[str]) -> Iterator[str]:
    shift: int | None = None  # of the lines of the code block that is open
    listed = spaced = False  # in a list; one with an empty line in it
    last = ""
    for number, line in enumerate(lines):
        fence = FENCE.match(line)
        deep = _indentation(line)
        if shift is not None:
            yield _shifted(line, shift)
            shift = None if fence else shift
            continue
        item = bool(ITEM.match(line))
        listed = item or (listed and (deep > 0 or not line.strip()))
        spaced = listed and (spaced or not line.strip())
        if item and spaced and last:
            yield ""
        last = line.strip()
        more = 4 * (deep // 2) - deep if listed else 0
        if fence:
            shift = more
            line = f"{fence[1]}```{fence[2] or _printed(lines[number + 1 :])}"
        yield _shifted(line, more)


def _printed(below: list[str]) -> str:
    """The mark of a code block of no language that begins with these lines."""
    block = list(takewhile(lambda line: not FENCE.match(line), below))
    told = any(map(MESSAGE.match, block))
    told &= all(len(line) < SHORT or MESSAGE.match(line) for line in block)
    return f" {{ .text .no-copy{' .messages' * told} }}"


def _indentation(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


def _shifted(line: str, more: int) -> str:
    """The line, moved to the right, or to the left as far as there is room."""
    if more < 0:
        return line[min(-more, _indentation(line)) :]
    return " " * more + line if line else line
