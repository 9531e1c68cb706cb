"""Text from files, shown to a person: a terminal must not obey what it contains."""

from __future__ import annotations


def printable(text: str) -> str:
    """The text with an escape such as \\x1b for each character that is not to be seen.

    These are control characters, which a terminal executes, marks that turn the direction of
    writing, and bytes of file names that are no text.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
