"""What a person reads on a terminal: text wrapped to the window, and colours for a verdict."""

from __future__ import annotations

import os

COLOURS = {
    "ok": "32", "good": "32", "unchanged": "32", "same": "32",
    "warning": "33", "rough": "33", "doubtful": "33", "unexplained": "33",
    "failed": "31", "not identifiable": "31", "changed": "31", "differ": "31",
}  # fmt: skip
NARROWEST, USUAL = 40, 80  # characters


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


def wrapped(start: str, text: str, indent: int, *, hanging: int = 0, descriptor: int = 1) -> str:
    """`start` of `indent` characters, and the text, wrapped to the window if there is one.

    The lines after the first one are indented by `hanging` more. A word is never broken, as it may
    be a name: one that is longer than the window is left to the terminal.
    """
    if not is_terminal(descriptor):
        return f"{start}{text}"
    import textwrap

    width = max(columns_of(descriptor), NARROWEST + indent)
    begin = indent + len(text) - len(text.lstrip())
    lines = textwrap.wrap(
        text.lstrip(),
        width,
        initial_indent=" " * begin,
        subsequent_indent=" " * (indent + hanging),
        break_long_words=False,
        break_on_hyphens=False,
    )
    return start + "\n".join(lines)[indent:]


def columns_of(descriptor: int) -> int:
    """The width of the window: as $COLUMNS says, else as the terminal does."""
    stated = os.environ.get("COLUMNS", "")
    if stated.isdecimal() and int(stated):
        return int(stated)
    try:
        return os.get_terminal_size(descriptor).columns or USUAL
    except OSError:
        return USUAL


def told(line: str) -> str:
    """A remark or an error as standard error shows it.

    A command line to copy stands behind a line break: in a window it begins a line, and is not
    wrapped; elsewhere each remark is one line.
    """
    text, _, command = line.partition("\n")
    if not is_terminal(2):
        return f"{text} {command}" if command else text
    shown = wrapped("", text, 0, hanging=2, descriptor=2)
    return f"{shown}\n  {command}" if command else shown
