"""The bytes of an Arrow stream, message by message, before pyarrow sees them."""

from __future__ import annotations

import struct
from collections import deque

from scarid_cli.errors import cut_short
from scarid_cli.io.bytesource import ByteSource, require_moderate
from scarid_cli.io.checksums import Verified, damaged
from scarid_cli.io.messages import CONTINUED, DICTIONARY, Bytes, Message, broken, number

END_OF_STREAM = CONTINUED + bytes(4)


class Incoming:
    """What pyarrow reads a stream from. Each message is weighed, and its checksum verified.

    A compressed batch of some kilobytes can take gigabytes of memory, and bad offsets in a batch
    can end the process.
    """

    def __init__(self, source: ByteSource) -> None:
        self._source = source
        self._pieces: deque[bytes | bytearray] = deque()  # of a message, not yet read
        self._verified = Verified(source.name)
        self._dictionaries = 0

    @property
    def closed(self) -> bool:
        return self._source.closed

    def close(self) -> None:
        """The source is closed where it was opened."""

    def read(self, size: int) -> bytes | bytearray:
        """So many bytes, fewer only at the end."""
        parts: list[bytes | bytearray] = []
        while size and (self._pieces or self._next()):
            piece = self._pieces.popleft()
            if len(piece) > size:
                self._pieces.appendleft(piece[size:])
                piece = piece[:size]
            parts.append(piece)
            size -= len(piece)
        return parts[0] if len(parts) == 1 else b"".join(parts)

    def require_whole(self) -> None:
        """Refuse a table that has no end mark, or ends before its time.

        pyarrow takes an end of file between two batches for the end of the table.
        """
        if self._source.last != END_OF_STREAM:
            raise cut_short(self._source.name)
        self._verified.end()
        if self._verified.empty and self._source.read_some():
            raise damaged(self._source.name)

    def _next(self) -> bool:
        """Read the next message, or the end mark; whether there was any."""
        try:
            return self._read()
        except (struct.error, ValueError):
            raise broken(self._source.name) from None

    def _read(self) -> bool:
        mark = self._source.read(4)
        length = self._source.read(4) if mark == CONTINUED else b""
        prefix = mark + length
        self._put(prefix)
        size = int.from_bytes(length or mark, "little")  # 0 at the end of the stream
        require_moderate(self._source.name, size)
        header = self._source.read(size)
        self._put(header)
        if size and len(header) == size:
            self._follow(prefix, header)
        return bool(prefix)

    def _follow(self, prefix: bytes, header: bytes) -> None:
        message = Message.of(header)
        require_moderate(self._source.name, message.body)
        body = self._source.filled(message.body)
        if len(body) == message.body:  # pyarrow notices if it is not
            self._weigh(message, body)
            self._verified.take(message, prefix, header, body)
        self._put(body)

    def _put(self, piece: bytes | bytearray) -> None:
        if piece:
            self._pieces.append(piece)

    def _weigh(self, message: Message, body: Bytes) -> None:
        size = message.unfolded(lambda at: number("<q", body, at))
        if message.kind == DICTIONARY:
            size = self._dictionaries = self._dictionaries + size
        require_moderate(self._source.name, size)
