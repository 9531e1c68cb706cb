"""Checksums of the batches of the Arrow tables that scarid writes; Arrow itself has none.

The metadata of each batch has a CRC-32, which other programs leave alone. It is that of all bytes
from the schema to the end of this batch, with zeros in place of each checksum, so that a batch that
is lost, repeated or elsewhere is noticed as well. A batch without rows marks the end of the table.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from functools import lru_cache
from typing import Any
from zlib import crc32

from scarid_cli.errors import BadData, cut_short
from scarid_cli.io.messages import CHECKSUM, DIGITS, MAGIC, PREFIX, RECORDS, Bytes, Message

UNKNOWN = b"0" * DIGITS
TO_BE_FILLED = {CHECKSUM: UNKNOWN}  # metadata of a batch


def filled(parts: Iterable[Any], before: int) -> tuple[list[Bytes], int]:
    """Whole messages, in parts as pyarrow writes them, with the checksums of the batches in them.

    `before` is the checksum of what precedes them; that of all is returned, too.
    """
    rest, done = deque(memoryview(part).cast("B") for part in parts if len(part)), list[Bytes]()
    if rest and rest[0] == MAGIC[: len(rest[0])]:  # before the schema of a file
        done += _taken(rest, len(MAGIC))
    while rest:
        prefix = b"".join(_taken(rest, PREFIX))
        header = bytearray().join(_taken(rest, int.from_bytes(prefix[4:], "little")))
        message = _described(bytes(header))
        body = _taken(rest, message.body)
        before = _added(before, prefix, header, *body)
        if at := message.checksum:
            header[at : at + DIGITS] = _digits(before)
        done += [prefix + header, *body]
    return done, before


@lru_cache(maxsize=8)
def _described(header: bytes) -> Message:
    """What a header says: that of a row that arrives is like that of the row before it."""
    return Message.of(header)


def _taken(rest: deque[memoryview], size: int) -> list[memoryview]:
    """The first bytes of these parts, so many of them."""
    taken = []
    while size:
        part = rest.popleft()
        if len(part) > size:
            rest.appendleft(part[size:])
            part = part[:size]
        taken.append(part)
        size -= len(part)
    return taken


def _added(checksum: int, *parts: Bytes) -> int:
    for part in parts:
        checksum = crc32(part, checksum)
    return checksum


class Verified:
    """The messages of a table, verified as they are read. Tables of others have no checksums.

    A table has a checksum in every batch or in none. One in which it differs has lost some.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._sum = 0
        self._rows = 0
        self._last: Message | None = None  # batch

    @property
    def empty(self) -> bool:
        """Whether there was no batch at all, not even one without rows."""
        return self._last is None

    def take(self, message: Message, prefix: bytes, header: bytes, body: Bytes) -> None:
        """The next message; a checksum that is missing or does not match is BadData."""
        if message.kind != RECORDS:
            self._sum = _added(self._sum, prefix, header, body)
            return
        if self._last and bool(self._last.checksum) != bool(message.checksum):
            raise self._damaged()
        if at := message.checksum:
            blank = header[:at] + UNKNOWN + header[at + DIGITS :]
            self._sum = _added(self._sum, prefix, blank, body)
            if _digits(self._sum) != header[at : at + DIGITS]:
                raise self._damaged()
        self._last = message
        self._rows += message.rows

    def end(self) -> None:
        """The table has ended; one that should have more batches is BadData."""
        if self._last and self._last.checksum and self._last.rows:
            raise cut_short(self._name)

    def _damaged(self) -> BadData:
        where = f"of the rows after row {self._rows}" if self._rows else "of the first rows"
        return damaged(self._name, where)


def damaged(name: str, where: str = "of its rows") -> BadData:
    """The error for an Arrow table that is not as scarid wrote it."""
    return BadData(
        f"{name}: the checksum {where} does not match; the table is damaged, write it again"
    )


def _digits(checksum: int) -> bytes:
    return b"%08x" % checksum
