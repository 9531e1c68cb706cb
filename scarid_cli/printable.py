"""Text from files, shown to a person: a terminal must not obey what it contains."""

from __future__ import annotations

import re

SURROGATE = re.compile("[\ud800-\udfff]")
ESCAPED = 0xDC00  # that Python adds to a byte which is no text


def printable(text: str) -> str:
    """The text with an escape such as \\x1b for each character that is not to be seen.

    These are control characters, which a terminal executes, marks that turn the direction of
    writing, and bytes of file names that are no text.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def utf8(text: str) -> str:
    """The text with an escape such as \\xff for each byte of a file name that is not UTF-8."""
    if text.isascii():
        return text
    return SURROGATE.sub(lambda found: _escape(ord(found[0])), text)


def _escape(code: int) -> str:
    return f"\\x{code - ESCAPED:02x}" if 0x80 <= code - ESCAPED <= 0xFF else f"\\u{code:04x}"
