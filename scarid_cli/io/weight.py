"""What the messages of an Arrow file unfold to, from their headers, before they do.

A compressed batch of some kilobytes can take gigabytes of memory, and pyarrow unfolds it first.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import BinaryIO

from scarid_cli.io.bytesource import require_moderate
from scarid_cli.io.checksums import damaged
from scarid_cli.io.messages import CONTINUED, Fields, Message, broken, number

BLOCK = 24  # bytes of the description of a message in the footer
FOOTER_END = 10  # bytes: the length of the footer, and ARROW1


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
            file.seek(end - number("<i", file.read(FOOTER_END), 0))
            data = file.read(end - file.tell())
            footer = Fields.root(data)
            listed = [[struct.unpack_from("<qi", data, at) for at in footer.entries(i, BLOCK)]
                      for i in (2, 3)]  # fmt: skip
        except (struct.error, ValueError, OSError):
            raise broken(name) from None
        return cls(name, file, listed[0], listed[1])

    def require_moderate(self, blocks: list[tuple[int, int]]) -> None:
        """Refuse messages that together unfold to more than memory should hold."""
        try:
            require_moderate(self.name, sum(self._unfolded(*block) for block in blocks))
        except (struct.error, ValueError, OSError):
            raise broken(self.name) from None

    def _unfolded(self, start: int, size: int) -> int:
        self.file.seek(start)
        header = self.file.read(size)
        skipped = 8 if header.startswith(CONTINUED) else 4
        message = Message.of(header[skipped:])
        if message.checksum:  # such a file is read in order, if all is well
            raise damaged(self.name)
        return message.unfolded(lambda at: self._length(start + size + at))

    def _length(self, at: int) -> int:
        self.file.seek(at)
        return number("<q", self.file.read(8), 0)
