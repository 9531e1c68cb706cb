"""The headers of the messages of an Arrow stream or file.

They are flatbuffers (Arrow's Message.fbs and File.fbs), of which a few fields are needed here;
pyarrow shows none of them.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass

from scarid_cli.errors import BadData

MAGIC = b"ARROW1\0\0"  # the start of a file
CONTINUED = b"\xff\xff\xff\xff"
PREFIX = 8  # bytes before a header: CONTINUED, and its length
SCHEMA, DICTIONARY, RECORDS = 1, 2, 3  # kinds of messages
ENTRY = 16  # bytes of the description of a buffer
OFFSET = 4  # and of the place of a table in a list
CHECKSUM = b"scarid.crc32"  # the key of the checksum of a batch (io/checksums.py)
DIGITS = 8  # of it
Bytes = bytes | bytearray | memoryview


@dataclass(frozen=True)
class Fields:
    """A table of a flatbuffer: where it begins in the bytes."""

    data: Bytes
    at: int

    @classmethod
    def root(cls, data: Bytes) -> Fields:
        """The table that a flatbuffer begins with."""
        return cls(data, number("<I", data, 0))

    def place(self, index: int) -> int:
        """Where the field of this index is; 0 if it is left out."""
        directory = self.at - number("<i", self.data, self.at)
        if 4 + 2 * index >= number("<H", self.data, directory):
            return 0
        offset = number("<H", self.data, directory + 4 + 2 * index)
        return self.at + offset if offset else 0

    def number(self, index: int, kind: str) -> int:
        """A number; 0 if it is left out."""
        return number(kind, self.data, at) if (at := self.place(index)) else 0

    def start(self, index: int) -> int:
        """Where a text begins; its length stands before it."""
        at = self.place(index)
        return at + number("<I", self.data, at) + 4 if at else 0

    def text(self, index: int) -> bytes:
        """A text; an empty one if it is left out."""
        if not (at := self.start(index)):
            return b""
        return bytes(self.data[at : at + number("<I", self.data, at - 4)])

    def table(self, index: int) -> Fields | None:
        """Another table."""
        at = self.place(index)
        return Fields(self.data, at + number("<I", self.data, at)) if at else None

    def entries(self, index: int, size: int) -> list[int]:
        """Where the entries of a list are, each of so many bytes."""
        if not (at := self.place(index)):
            return []
        start = at + number("<I", self.data, at)
        count = number("<I", self.data, start)
        if start + 4 + count * size > len(self.data):
            raise ValueError("a list beyond the end of its message")
        return [start + 4 + i * size for i in range(count)]


@dataclass(frozen=True)
class Message:
    """A message: its kind, the bytes of its body, and where in the body compressed buffers are.

    `rows` of a batch, and where in the header its `checksum` is (0: it has none).
    """

    kind: int
    body: int
    compressed: tuple[int, ...]
    plain: int  # bytes of the buffers that are not compressed
    rows: int = 0
    checksum: int = 0

    @classmethod
    def of(cls, header: Bytes) -> Message:
        """The message with this header."""
        message = Fields.root(header)
        kind, body = message.number(1, "<B"), message.number(3, "<q")
        if body < 0:
            raise ValueError("a body of fewer bytes than none")
        records = message.table(2) if kind in (DICTIONARY, RECORDS) else None
        records = records.table(1) if records and kind == DICTIONARY else records
        rows, checksum = records.number(0, "<q") if records else 0, _checksum(message)
        if records is None or not records.place(3):
            return cls(kind, body, (), body, rows, checksum)
        places = records.entries(2, ENTRY)
        buffers = [struct.unpack_from("<qq", header, at) for at in places]
        compressed = tuple(start for start, size in buffers if size > 0)
        return cls(kind, body, compressed, 0, rows, checksum)

    def unfolded(self, read: Callable[[int], int]) -> int:
        """The bytes of its buffers; `read` gives the number that a compressed one begins with.

        This is the length that the buffer unfolds to, or -1 if it is not compressed after all.
        """
        lengths = [read(start) for start in self.compressed]
        return self.plain + sum(max(length, 0) for length in lengths) + self.body


def _checksum(message: Fields) -> int:
    """Where the digits of the checksum of a batch are, in its metadata; 0 if it has none."""
    if message.number(1, "<B") != RECORDS:
        return 0
    for at in message.entries(4, OFFSET):
        pair = Fields(message.data, at + number("<I", message.data, at))
        if pair.text(0) == CHECKSUM and len(pair.text(1)) == DIGITS:
            return pair.start(1)
    return 0


def number(kind: str, data: Bytes, at: int) -> int:
    """The number of this kind (as struct names it) at a place."""
    if at < 0:
        raise ValueError("a place before the start")
    return int(struct.unpack_from(kind, data, at)[0])


def broken(name: str) -> BadData:
    """The error for an Arrow table whose messages cannot be understood."""
    return BadData(f"{name}: not a complete Arrow table (a message is broken); write it again")
