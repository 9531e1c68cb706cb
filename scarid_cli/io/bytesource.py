"""Bytes of a file or of standard input, as they arrive."""

from __future__ import annotations

import os
import select
import stat
from typing import BinaryIO

from scarid_cli.errors import BadData, OutputFailure, UsageFault
from scarid_cli.io.stop import STOP

STDIN = "<stdin>"
CHUNK = 1 << 20
PIPE = 1 << 16  # bytes that a pipe holds; room for more would be made and given back at each row
GZIP, GZIP_BITS = b"\x1f\x8b", 31  # its first bytes, and the format as zlib knows it
UTF_16 = (b"\xff\xfe", b"\xfe\xff")  # how such text begins
MAX_BATCH = 1 << 29  # bytes
ROWS = 8  # a single row may take this part of it


def max_batch() -> int:
    """How many bytes a part of the input may unfold to, from SCARID_MAX_BATCH [MB] if it is set."""
    text = os.environ.get("SCARID_MAX_BATCH")
    if not text:
        return MAX_BATCH
    if not text.isdecimal() or not 0 < int(text) < 1 << 40:
        raise UsageFault(f"SCARID_MAX_BATCH={text}: give a whole number of megabytes")
    return int(text) * 1_000_000


def require_moderate(name: str, size: int) -> None:
    """Refuse an input of which a part would take so many bytes of memory."""
    if size > max_batch():
        raise BadData(
            f"{name}: a part of it takes {size / 1e6:.0f} MB of memory, more than "
            f"{max_batch() / 1e6:.0f} MB; write it in smaller groups of rows, or set "
            "SCARID_MAX_BATCH to more megabytes"
        )


def require_moderate_row(name: str, size: int) -> None:
    """Refuse an input of which a row would take so many bytes: it is held in several forms."""
    if size > max_batch() // ROWS:
        raise BadData(
            f"{name}: a row of it takes {size / 1e6:.0f} MB of memory, more than "
            f"{max_batch() / ROWS / 1e6:.0f} MB; correct it, or set SCARID_MAX_BATCH to more "
            "megabytes"
        )


class ByteSource:
    """A readable file descriptor.

    `read(n)` waits for exactly n bytes, as pyarrow expects; `read_some` returns what has arrived.
    `last` holds the last eight bytes that were returned: those of an Arrow stream are its end mark.
    """

    def __init__(self, fd: int, name: str) -> None:
        self.fd = fd
        self.name = name
        self.last = b""
        self.closed = False
        self._ahead = b""
        self._spool: BinaryIO | None = None
        self._live: bool | None = None

    @classmethod
    def open(cls, path: str) -> ByteSource:
        """Open a path, or standard input for `-`."""
        if path == "-":
            if os.isatty(0):
                raise UsageFault("no input: give a FILE, or pipe a table into the command")
            return cls(0, STDIN)
        try:
            return cls(os.open(path, os.O_RDONLY | os.O_CLOEXEC), path)
        except FileNotFoundError:
            raise UsageFault(f"{path}: no such file") from None
        except OSError as error:
            raise OutputFailure(f"{path}: {error.strerror}") from None

    def peek(self, size: int) -> bytes:
        """The next bytes (fewer only at the end), without consuming them."""
        while len(self._ahead) < size:
            data = self._fetch(size - len(self._ahead))
            if not data:
                break
            self._ahead += data
        return self._ahead[:size]

    def peek_lines(self, count: int) -> bytes:
        """At least the next lines (fewer only at the end), without consuming them."""
        parts, lines, size = [self._ahead], self._ahead.count(b"\n"), len(self._ahead)
        while lines < count and (data := self._fetch(CHUNK)):
            parts.append(data)
            lines, size = lines + data.count(b"\n"), size + len(data)
            require_moderate_row(self.name, size // (lines + 1))
        self._ahead = b"".join(parts)
        return self._ahead

    def drop_lines(self, count: int) -> None:
        """Leave out the first lines."""
        for _ in range(count):
            self.read(self.peek_lines(1).find(b"\n") + 1 or -1)

    def drop_comments(self, marks: bytes) -> None:
        """Leave out the lines at the start that begin with one of these characters."""
        while (start := self.peek(1)) and start in marks:
            self.drop_lines(1)

    def read_some(self, size: int = CHUNK) -> bytes:
        """What has arrived: at least one byte, or none at the end."""
        if not self._ahead:
            self._ahead = self._fetch(max(size, PIPE) if self._live else size)
        data, self._ahead = self._ahead[:size], self._ahead[size:]
        self.last = (self.last + data[-8:])[-8:]
        return data

    def waits(self) -> bool:
        """Whether more of a pipe has arrived already."""
        if not self._live:
            return False
        poll = select.poll()
        poll.register(self.fd, select.POLLIN)
        return bool(self._ahead or poll.poll(0))

    def filled(self, size: int) -> bytearray:
        """Exactly `size` bytes, fewer only at the end, like `read`, but without copies of them."""
        data, start = bytearray(size), self._ahead[:size]
        self._ahead = self._ahead[size:]
        data[: (done := len(start))] = start
        with memoryview(data) as view:
            while done < size and (count := self._fetch_into(view[done:])):
                done += count
        del data[done:]
        self.last = (self.last + data[-8:])[-8:]
        return data

    def read(self, size: int = -1) -> bytes:
        """Exactly `size` bytes, fewer only at the end; all of them for a negative size."""
        parts: list[bytes] = []
        left = size
        while left:
            data = self.read_some(left if size >= 0 else CHUNK)
            if not data:
                break
            parts.append(data)
            left -= len(data)
        return parts[0] if len(parts) == 1 else b"".join(parts)

    @property
    def regular(self) -> bool:
        """Whether this is a regular file, rather than a pipe or a terminal."""
        return stat.S_ISREG(os.fstat(self.fd).st_mode)

    def part_read(self) -> float | None:
        """Which part of a regular file was read in order so far; None for a pipe."""
        if not stat.S_ISREG(os.fstat(self.fd).st_mode):
            return None
        return os.lseek(self.fd, 0, os.SEEK_CUR) / max(os.fstat(self.fd).st_size, 1)

    def seekable(self) -> BinaryIO:
        """A seekable file of all the bytes: the source itself, or a temporary copy of a pipe."""
        if self._spool is None:
            self._spool = os.fdopen(os.dup(self.fd), "rb") if self.regular else self._copied()
        return self._spool

    def _copied(self) -> BinaryIO:
        import tempfile

        try:
            spool = tempfile.TemporaryFile()  # noqa: SIM115 (closed with the source)
            while data := self.read_some():
                spool.write(data)
            spool.seek(0)
        except OSError as error:
            raise OutputFailure(
                f"{self.name}: no temporary copy can be made of it ({error.strerror}); give a file "
                "in place of a pipe, or set TMPDIR to a folder with more space"
            ) from None
        return spool

    def close(self) -> None:
        """Close the descriptor, unless it is standard input."""
        if self._spool:
            self._spool.close()
        if self.fd and not self.closed:
            os.close(self.fd)
        self.closed = True

    def sha256(self) -> str | None:
        """The digest of a regular file, as `sha256sum` prints it; None for a pipe."""
        if not self.regular:
            return None
        import hashlib  # a few milliseconds that a pipe need not pay

        digest = hashlib.sha256()
        offset = 0
        while data := os.pread(self.fd, CHUNK, offset):
            digest.update(data)
            offset += len(data)
        return digest.hexdigest()

    def _fetch(self, size: int) -> bytes:
        if not self._arrives():
            return b""
        try:
            data = os.read(self.fd, min(size, PIPE) if self._live else size)
        except OSError as error:
            raise OutputFailure(f"{self.name}: {error.strerror}") from None
        STOP.live |= bool(self._live and data)
        return data

    def _fetch_into(self, view: memoryview) -> int:
        if not self._arrives():
            return 0
        try:
            return os.readv(self.fd, [view])
        except OSError as error:
            raise OutputFailure(f"{self.name}: {error.strerror}") from None

    def _arrives(self) -> bool:
        """Wait for bytes, or for the end; False if a signal has ended the input."""
        if self._live is None:
            self._live = not stat.S_ISREG(os.fstat(self.fd).st_mode)
        return not self._live or STOP.readable(self.fd)


class Wrapped(ByteSource):
    """The bytes of another source after a change."""

    def __init__(self, source: ByteSource) -> None:
        super().__init__(source.fd, source.name)
        self.source = source

    @property
    def regular(self) -> bool:
        """A changed file is read in order, like a pipe."""
        return False

    def _fetch_into(self, view: memoryview) -> int:
        data = self._fetch(len(view))
        view[: len(data)] = data
        return len(data)


class Unzipped(Wrapped):
    """The contents of a gzip file."""

    def __init__(self, source: ByteSource) -> None:
        import zlib

        super().__init__(source)
        self._zlib = zlib
        self._member = zlib.decompressobj(GZIP_BITS)

    def _fetch(self, size: int) -> bytes:
        while True:
            rest = self._member.unconsumed_tail or self._member.unused_data
            data = rest or self.source.read_some(size)
            if not data and not self._member.eof:
                raise BadData(f"{self.name}: a gzip file that was cut short; copy it again")
            if self._member.eof and data:  # files that were joined
                self._member = self._zlib.decompressobj(GZIP_BITS)
            try:
                found = self._member.decompress(data, size)  # a little can unfold to gigabytes
            except self._zlib.error as error:
                raise BadData(f"{self.name}: a broken gzip file ({error}); copy it again") from None
            if found or not data:
                return found


class Reencoded(Wrapped):
    """Text in UTF-16, as Excel and PowerShell write it, in UTF-8."""

    def __init__(self, source: ByteSource) -> None:
        import codecs

        super().__init__(source)
        self._decoder = codecs.getincrementaldecoder("utf-16")()
        self._ready = b""

    def _fetch(self, size: int) -> bytes:
        while not self._ready:
            data = self.source.read_some(size)
            try:
                self._ready = self._decoder.decode(data, final=not data).encode()
            except UnicodeError:
                raise BadData(f"{self.name}: broken text in UTF-16; copy it again") from None
            if not data:
                break
        found, self._ready = self._ready[:size], self._ready[size:]
        return found


def unpacked(source: ByteSource) -> ByteSource:
    """The source, or its contents if it is a gzip file; text in UTF-8."""
    source = Unzipped(source) if source.peek(2) == GZIP else source
    return Reencoded(source) if source.peek(2) in UTF_16 else source
