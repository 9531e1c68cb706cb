"""What a person reads on a terminal: text wrapped to the window, and colours for a verdict."""

from __future__ import annotations

import os

COLOURS = {
    "ok": "32", "good": "32", "unchanged": "32",
    "warning": "33", "doubtful": "33", "unexplained": "33",
    "failed": "31", "not identifiable": "31", "changed": "31",
}  # fmt: skip
NARROWEST = 40  # characters


def is_terminal(descriptor: int = 1) -> bool:
    """Whether standard output (1) or standard error (2) is a terminal."""
    return os.isatty(descriptor)


def coloured(descriptor: int = 1) -> bool:
    """Whether the same shows colours: see https://no-color.org."""
    plain = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return is_terminal(descriptor) and not plain


def styled(text: str, verdict: str, descriptor: int = 1) -> str:
    """The text in the colour of a verdict, where the output shows colours."""
    code = COLOURS.get(verdict)
    return f"\033[{code}m{text}\033[0m" if code and coloured(descriptor) else text


def wrapped(start: str, text: str, indent: int, *, hanging: int = 0) -> str:
    """`start` of `indent` characters, and the text, wrapped to the window if there is one.

    The lines after the first one are indented by `hanging` more.
    """
    if not is_terminal():
        return f"{start}{text}"
    import shutil
    import textwrap

    width = max(shutil.get_terminal_size().columns, NARROWEST + indent)
    begin = indent + len(text) - len(text.lstrip())
    lines = textwrap.wrap(
        text.lstrip(),
        width,
        initial_indent=" " * begin,
        subsequent_indent=" " * (indent + hanging),
    )
    return start + "\n".join(lines)[indent:]
