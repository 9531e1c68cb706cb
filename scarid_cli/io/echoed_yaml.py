"""Messages as `ros2 topic echo` and `rostopic echo` print them: YAML, with --- after each.

Only what these commands print is read: keys, numbers, texts, and lists of them. Objects inside
objects become columns a.b, lists columns a[0], a[1], ..., as in JSON.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.jsonio import lines_of, table_of_rows
from scarid_cli.io.table import Table

FIRST = re.compile(rb"(?:---\s*\n)?[A-Za-z_]\w*:[ \t]*\r?\n[ \t]*(?:- \S|\w+:)")
PAIR = re.compile(r"(?P<indent> *)(?P<key>[A-Za-z_]\w*):(?:\s+(?P<value>.*))?")
ITEM = re.compile(r" *- (?P<value>.*)")
END = "---"
CUT = "..."  # stands for what is left out of a long array
SPECIAL = {".nan": "nan", ".inf": "inf", "-.inf": "-inf"}
EXPECTED = "`key: value` or `- value`, as `ros2 topic echo` prints them"


def is_echoed(source: ByteSource) -> bool:
    """Whether a file begins as a message that was printed: a key alone in its line, and more."""
    return FIRST.match(source.peek(64).lstrip(b"\xef\xbb\xbf\r\n")) is not None


def read_echoed(source: ByteSource, tell: Callable[[str], object]) -> Table:
    """A table with a row for each message; `tell` hears of a last one that is not whole."""
    return table_of_rows(_messages(source, tell), source.name)


def _messages(source: ByteSource, tell: Callable[[str], object]) -> Iterator[dict[str, Any]]:
    held: list[tuple[int, str]] = []
    count = 0
    for number, raw in enumerate(lines_of(source), start=1):
        line = raw.decode(errors="replace").rstrip()
        if line != END:
            held.append((number, line))
        elif held:
            message = _Message(source.name)
            for own, text in held:
                message.add(text, own)
            yield message.values
            held, count = [], count + 1
    if held and not count:
        raise BadData(
            f"{source.name}: YAML, but no message with {END} after it as `ros2 topic echo` prints "
            "them; give a recorded bag, or a table"
        )
    if held:
        tell(f"{source.name}: the last message has no {END} after it, and is left out")


class _Message:
    """One message, line by line: objects by their indent, of which the last ones are open."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.values: dict[str, Any] = {}
        self._open: list[tuple[int, dict[str, Any]]] = [(0, self.values)]
        self._key = ""

    def add(self, line: str, number: int) -> None:
        """The next line: a pair, or an item of the list whose key stands above it."""
        own = self._open[-1][1]
        if (item := ITEM.fullmatch(line)) and self._key:
            value = item["value"].strip()
            self._require_whole(value, number)
            if PAIR.fullmatch(value) or value.startswith(("- ", "[", "{")):
                raise self._fault(line, number)
            if not isinstance(own.get(self._key), list):
                own[self._key] = []
            own[self._key].append(_value(value))
            return
        pair = PAIR.fullmatch(line)
        if not pair:
            raise self._fault(line, number)
        self._place(len(pair["indent"]))
        self._set(pair["key"], (pair["value"] or "").strip(), number)

    def _place(self, indent: int) -> None:
        """Open the object of the last key if the line is within it, or close those that end."""
        if indent > self._open[-1][0]:
            inner: dict[str, Any] = {}
            self._open[-1][1][self._key] = inner
            self._open.append((indent, inner))
        while indent < self._open[-1][0]:
            self._open.pop()

    def _set(self, key: str, value: str, number: int) -> None:
        own, self._key = self._open[-1][1], key
        self._require_whole(value, number)
        if value in ("[]", "{}") or not value:
            own.pop(key, None)
        elif value.startswith("[") and value.endswith("]"):
            own[key] = [_value(x.strip()) for x in value[1:-1].split(",")]
        else:
            own[key] = _value(value)

    def _require_whole(self, value: str, number: int) -> None:
        if value.strip("'\"[] ").endswith(CUT):
            raise BadData(
                f"{self.name}, line {number}: an array that is cut short by {CUT}; print it again "
                "with `ros2 topic echo --full-length`, or record a bag"
            )

    def _fault(self, line: str, number: int) -> BadData:
        remedy = "record a bag of the topic (`ros2 bag record TOPIC`), which scarid reads"
        return bad_data(
            self.name, f"line {number}: {line[:40]!r}", expected=EXPECTED, remedy=remedy
        )


def _value(text: str) -> Any:
    """A number, or a text without its quotes."""
    plain = SPECIAL.get(text.lower(), text)
    try:
        return int(plain) if re.fullmatch(r"[-+]?\d+", plain) else float(plain)
    except ValueError:
        return text.strip("'\"")
