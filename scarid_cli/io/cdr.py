"""Where the numbers and texts of a serialised ROS message are.

A ROS 2 message is CDR: four bytes that state the notation, then the fields in order, each number
at a multiple of its size. A ROS 1 message has neither. The layout of one message is that of the
next, unless an array grows, or a text changes: then numbers of both can be read through one view.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

BASE, NAME, ARRAY, SEQUENCE = 1, 2, 3, 4  # rosbags' kinds of nodes in the definition of a type
CODES = {
    "bool": "u1", "byte": "u1", "char": "u1", "octet": "u1", "uint8": "u1", "int8": "i1",
    "uint16": "u2", "int16": "i2", "uint32": "u4", "int32": "i4", "uint64": "u8", "int64": "i8",
    "float32": "f4", "float64": "f8",
}  # fmt: skip
CDR2 = 6  # the first notation in which numbers of eight bytes are at multiples of four
NEAR = 8  # bytes between two fixed pieces that are compared together

# From the name of a type to its constants and its fields, as rosbags parses a definition.
Definitions = Mapping[str, tuple[Any, list[tuple[str, Any]]]]


@dataclass(frozen=True)
class Numbers:
    """Equal numbers in a row: where they begin, how many, and their numpy type."""

    offset: int
    count: int
    type: str


@dataclass(frozen=True)
class Layout:
    """The numbers and the texts of a message by the path of their field, such as `points.0.effort`.

    A message of this `size` in bytes has the same layout if its `fixed` pieces are the same: the
    lengths of arrays and texts, and the texts.
    """

    size: int
    numbers: dict[str, Numbers]
    texts: dict[str, list[str]]
    fixed: tuple[tuple[int, int, bytes], ...]

    def fits(self, message: bytes) -> bool:
        """Whether a message has this layout."""
        return len(message) == self.size and all(
            message[start:end] == piece for start, end, piece in self.fixed
        )


def layout(message: bytes, kind: str, definitions: Definitions, *, cdr: bool) -> Layout:
    """The layout of a message of this type.

    Raises ValueError if the message is shorter than its type says, and KeyError for a type that is
    not defined.
    """
    reader = _Reader(message, definitions)
    if cdr:
        reader.begin_cdr()
    reader.message("", kind)
    return Layout(len(message), reader.numbers, reader.texts, reader.joined_pieces())


@dataclass
class _Reader:
    """Goes through one message; `widest` is the largest multiple that numbers are at."""

    data: bytes
    definitions: Definitions
    at: int = 0
    origin: int = 0
    widest: int = 1
    order: str = "<"
    numbers: dict[str, Numbers] = field(default_factory=dict)
    texts: dict[str, list[str]] = field(default_factory=dict)
    pieces: list[tuple[int, int]] = field(default_factory=list)

    def begin_cdr(self) -> None:
        """Read which notation the rest is in."""
        if len(self.data) < 4:
            raise ValueError("the message is empty")
        self.order = "<" if self.data[1] & 1 else ">"
        self.widest = 4 if self.data[1] >= CDR2 else 8
        self.at = self.origin = 4

    def message(self, path: str, kind: str) -> None:
        for name, node in self.definitions[kind][1]:
            self.value(f"{path}{name}", node)

    def value(self, path: str, node: Any) -> None:
        kind, content = node
        if kind == NAME:
            self.message(f"{path}.", content)
        elif kind == BASE:
            self.elements(path, node, 1)
        else:
            element, length = content
            self.elements(path, element, self.length() if kind == SEQUENCE else length)

    def elements(self, path: str, element: Any, count: int) -> None:
        kind, content = element
        if kind == BASE and content[0] in CODES:
            self.numbers[path] = self.array(CODES[content[0]], count)
        elif kind == BASE:
            self.texts[path] = [self.text() for _ in range(count)]
        else:
            for k in range(count):
                self.value(f"{path}.{k}", element)

    def array(self, code: str, count: int) -> Numbers:
        size = int(code[1])
        if count:
            self.align(size)
        found = Numbers(self.at, count, self.order + code)
        self.advance(size * count)
        return found

    def text(self) -> str:
        size = self.length()
        start = self.at
        self.advance(size)
        self.pieces.append((start, self.at))
        return self.data[start : self.at].rstrip(b"\0").decode(errors="replace")

    def length(self) -> int:
        self.align(4)
        start = self.at
        self.advance(4)
        self.pieces.append((start, self.at))
        return int(struct.unpack_from(f"{self.order}I", self.data, start)[0])

    def align(self, size: int) -> None:
        multiple = min(size, self.widest)
        self.at += (self.origin - self.at) % multiple

    def advance(self, size: int) -> None:
        self.at += size
        if self.at > len(self.data):
            raise ValueError(f"it ends after {len(self.data)} bytes, within a field")

    def joined_pieces(self) -> tuple[tuple[int, int, bytes], ...]:
        """The fixed pieces; those that only padding separates are one."""
        joined: list[tuple[int, int]] = []
        for start, end in self.pieces:
            if joined and start - joined[-1][1] < NEAR:
                start = joined.pop()[0]
            joined.append((start, end))
        return tuple((start, end, self.data[start:end]) for start, end in joined)
