"""What the messages of an Arrow stream or file unfold to, from their headers, before they do.

A compressed batch of some kilobytes can take gigabytes of memory. The headers are flatbuffers
(Arrow's Message.fbs and File.fbs), of which a few fields are needed here; pyarrow shows none of
them.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import BinaryIO

from scarid_cli.errors import BadData
from scarid_cli.io.bytesource import ByteSource, require_moderate

CONTINUED = b"\xff\xff\xff\xff"
DICTIONARY, RECORDS = 2, 3  # kinds of messages
ENTRY = 16  # bytes of the description of a buffer
BLOCK = 24  # and of that of a message in the footer of a file
FOOTER_END = 10  # bytes: the length of the footer, and ARROW1
Bytes = bytes | memoryview


@dataclass(frozen=True)
class Fields:
    """A table of a flatbuffer: where it begins in the bytes."""

    data: Bytes
    at: int

    @classmethod
    def root(cls, data: Bytes) -> Fields:
        """The table that a flatbuffer begins with."""
        return cls(data, _number("<I", data, 0))

    def place(self, index: int) -> int:
        """Where the field of this index is; 0 if it is left out."""
        directory = self.at - _number("<i", self.data, self.at)
        if 4 + 2 * index >= _number("<H", self.data, directory):
            return 0
        offset = _number("<H", self.data, directory + 4 + 2 * index)
        return self.at + offset if offset else 0

    def number(self, index: int, kind: str) -> int:
        """A number; 0 if it is left out."""
        return _number(kind, self.data, at) if (at := self.place(index)) else 0

    def table(self, index: int) -> Fields | None:
        """Another table."""
        at = self.place(index)
        return Fields(self.data, at + _number("<I", self.data, at)) if at else None

    def entries(self, index: int, size: int) -> list[int]:
        """Where the entries of a list are, each of so many bytes."""
        if not (at := self.place(index)):
            return []
        start = at + _number("<I", self.data, at)
        count = _number("<I", self.data, start)
        if start + 4 + count * size > len(self.data):
            raise ValueError("a list beyond the end of its message")
        return [start + 4 + i * size for i in range(count)]


@dataclass(frozen=True)
class Message:
    """A message: its kind, the bytes of its body, and where in the body compressed buffers are."""

    kind: int
    body: int
    compressed: tuple[int, ...]
    plain: int  # bytes of the buffers that are not compressed

    @classmethod
    def of(cls, header: Bytes) -> Message:
        """The message with this header."""
        message = Fields.root(header)
        kind, body = message.number(1, "<B"), message.number(3, "<q")
        records = message.table(2) if kind in (DICTIONARY, RECORDS) else None
        records = records.table(1) if records and kind == DICTIONARY else records
        if records is None or not records.place(3):
            return cls(kind, body, (), body)
        places = records.entries(2, ENTRY)
        buffers = [struct.unpack_from("<qq", header, at) for at in places]
        return cls(kind, body, tuple(start for start, size in buffers if size > 0), 0)

    def unfolded(self, read: Callable[[int], int]) -> int:
        """The bytes of its buffers; `read` gives the number that a compressed one begins with.

        This is the length that the buffer unfolds to, or -1 if it is not compressed after all.
        """
        lengths = [read(start) for start in self.compressed]
        return self.plain + sum(max(length, 0) for length in lengths) + self.body


class Weighed:
    """The bytes of an Arrow stream, whose messages are weighed as pyarrow reads them."""

    def __init__(self, source: ByteSource) -> None:
        self._source = source
        self._parts: list[bytes] = []
        self._missing = 4
        self._next: Callable[[Bytes], int] = self._begun
        self._message = Message(0, 0, (), 0)
        self._dictionaries = 0

    @property
    def closed(self) -> bool:
        return self._source.closed

    def close(self) -> None:
        """The source is closed where it was opened."""

    def read(self, size: int = -1) -> bytes:
        """So many bytes, as the source gives them."""
        data = self._source.read(size)
        try:
            self._follow(memoryview(data))
        except (struct.error, ValueError):
            raise _broken(self._source.name) from None
        return data

    def _follow(self, data: memoryview) -> None:
        """Gather the bytes of the next part of a message, and take it once they are there."""
        while len(data) >= self._missing > 0:
            part, data = data[: self._missing], data[self._missing :]
            whole = b"".join([*self._parts, part]) if self._parts else part
            self._parts, self._missing = [], 0
            self._missing = self._next(whole)
        if len(data) and self._missing:
            self._parts.append(bytes(data))
            self._missing -= len(data)

    def _begun(self, prefix: Bytes) -> int:
        if prefix == CONTINUED:
            self._next = self._begun
            return 4
        self._next = self._described
        return int.from_bytes(prefix, "little")  # 0 at the end of the stream

    def _described(self, header: Bytes) -> int:
        self._message = Message.of(header)
        require_moderate(self._source.name, self._message.body)
        if self._message.body <= 0:
            self._next = self._begun
            return 4
        self._next = self._filled
        return self._message.body

    def _filled(self, body: Bytes) -> int:
        size = self._message.unfolded(lambda at: _number("<q", body, at))
        if self._message.kind == DICTIONARY:
            size = self._dictionaries = self._dictionaries + size
        require_moderate(self._source.name, size)
        self._next = self._begun
        return 4


@dataclass(frozen=True)
class Blocks:
    """The messages of an Arrow file, as its footer lists them."""

    name: str
    file: BinaryIO
    dictionaries: list[tuple[int, int]]  # where they begin, and the bytes of their header
    records: list[tuple[int, int]]

    @classmethod
    def of(cls, name: str, file: BinaryIO) -> Blocks:
        """The messages of a file."""
        try:
            end = file.seek(-FOOTER_END, 2)
            file.seek(end - _number("<i", file.read(FOOTER_END), 0))
            data = file.read(end - file.tell())
            footer = Fields.root(data)
            listed = [[struct.unpack_from("<qi", data, at) for at in footer.entries(i, BLOCK)]
                      for i in (2, 3)]  # fmt: skip
        except (struct.error, ValueError, OSError):
            raise _broken(name) from None
        return cls(name, file, listed[0], listed[1])

    def require_moderate(self, blocks: list[tuple[int, int]]) -> None:
        """Refuse messages that together unfold to more than memory should hold."""
        try:
            require_moderate(self.name, sum(self._unfolded(*block) for block in blocks))
        except (struct.error, ValueError, OSError):
            raise _broken(self.name) from None

    def _unfolded(self, start: int, size: int) -> int:
        self.file.seek(start)
        header = self.file.read(size)
        skipped = 8 if header.startswith(CONTINUED) else 4
        message = Message.of(header[skipped:])
        return message.unfolded(lambda at: self._length(start + size + at))

    def _length(self, at: int) -> int:
        self.file.seek(at)
        return _number("<q", self.file.read(8), 0)


def _number(kind: str, data: Bytes, at: int) -> int:
    if at < 0:
        raise ValueError("a place before the start")
    return int(struct.unpack_from(kind, data, at)[0])


def _broken(name: str) -> BadData:
    return BadData(f"{name}: not a complete Arrow table (a message is broken); write it again")
