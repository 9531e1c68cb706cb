"""What a person reads on a terminal: text wrapped to the window, and colours for a verdict."""

from __future__ import annotations

import os
import shutil
import sys
import textwrap

COLOURS = {
    "ok": "32", "good": "32", "unchanged": "32",
    "warning": "33", "doubtful": "33", "unexplained": "33",
    "failed": "31", "not identifiable": "31", "changed": "31",
}  # fmt: skip
NARROWEST = 40  # characters


def is_terminal() -> bool:
    """Whether standard output is a terminal."""
    return os.isatty(1) and sys.stdout.isatty()


def coloured() -> bool:
    """Whether standard output shows colours: see https://no-color.org."""
    return is_terminal() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def styled(text: str, verdict: str) -> str:
    """The text in the colour of a verdict, where standard output shows colours."""
    code = COLOURS.get(verdict)
    return f"\033[{code}m{text}\033[0m" if code and coloured() else text


def wrapped(start: str, text: str, indent: int) -> str:
    """`start` of `indent` characters, and the text, wrapped to the window if there is one."""
    if not is_terminal():
        return f"{start}{text}"
    width = max(shutil.get_terminal_size().columns, NARROWEST + indent)
    lines = textwrap.wrap(text, width - indent) or [""]
    return start + f"\n{' ' * indent}".join(lines)
