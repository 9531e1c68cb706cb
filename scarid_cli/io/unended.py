"""MCAP files whose end is missing, as when the recorder was killed or the disk was full.

The complete records before the damage are a recording: they are copied and get an end. A chunk that
is cut is lost as a whole, because it is compressed.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import BinaryIO

MAGIC = b"\x89MCAP0\r\n"
RECORD = struct.Struct("<BQ")  # kind and length
LASTING = {0x01, 0x03, 0x04, 0x05, 0x06, 0x07}  # header, schema, channel, message, chunk, index
DATA_END = RECORD.pack(0x0F, 4) + bytes(4)
FOOTER = RECORD.pack(0x02, 20) + bytes(20)
PIECE = 1 << 20  # bytes that are copied at a time


def has_no_end(path: Path) -> bool:
    """Whether a file begins as MCAP and does not end as one."""
    with path.open("rb") as file:
        begins = file.read(len(MAGIC)) == MAGIC
        size = file.seek(0, 2)
        file.seek(max(size - len(MAGIC), 0))
        return begins and file.read() != MAGIC


def ended(path: Path, copy: Path) -> None:
    """Write the complete records of a file to another one, with an end."""
    with path.open("rb") as source, copy.open("wb") as target:
        size = source.seek(0, 2)
        source.seek(len(MAGIC))
        target.write(MAGIC)
        while (head := source.read(RECORD.size)) and len(head) == RECORD.size:
            kind, length = RECORD.unpack(head)
            if kind not in LASTING or source.tell() + length > size:
                break
            target.write(head)
            _copied(source, target, length)
        target.write(DATA_END + FOOTER + MAGIC)


def _copied(source: BinaryIO, target: BinaryIO, length: int) -> None:
    while length:
        piece = source.read(min(length, PIECE))
        target.write(piece)
        length -= len(piece)
