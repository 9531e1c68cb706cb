"""Rows of CSV that come to a port of this machine, by TCP or UDP, as one table."""

from __future__ import annotations

import csv
import errno
import socket
import time
from collections.abc import Iterator

from scarid_cli.errors import BadData, OutputFailure, UsageFault
from scarid_cli.io.bytesource import CHUNK, ByteSource
from scarid_cli.io.losses import Losses, Parts
from scarid_cli.io.stop import STOP
from scarid_cli.io.table import SEGMENT

LONGEST = 1 << 20  # bytes of a row
PACKET = 1 << 16  # bytes; no packet of UDP is longer
AT_ONCE = 256  # packets, after which they are passed on
BUFFER = 1 << 22  # bytes that the kernel is asked to keep while a later command is busy


class Rows:
    """Tells rows from headers and from what is neither, and counts."""

    def __init__(self, place: str, columns: str, *, split: bool = False) -> None:
        self._place = place
        self._parts = Parts() if split else None
        self._header: list[str] = []
        self._time: int | None = None  # the number of the time column
        self._begun = b""  # the header line, until it is passed on
        self._fresh = self._again = False
        self.count = 0
        self.broken = 0
        self.losses = Losses()
        if columns:
            self._name(_fields(columns), columns.encode())

    def source_begins(self) -> None:
        """A source has connected: its time may begin again."""
        self._fresh = True

    def passed(self, line: bytes) -> bytes:
        """What the table gets of a line."""
        line = line.strip()
        fields = _fields(line.decode(errors="replace"))
        if not fields or line.startswith(b"#"):
            return b""
        if not self._header:
            if any(map(_is_number, fields)):
                raise BadData(
                    f"{self._place}: found numbers in the first line, expected a header; name the "
                    "columns with --columns t,q1,..."
                )
            self._name(fields, line)
        start, self._begun = self._begun, b""
        return start + (self._numbered(line, fields) if self._is_row(fields) else b"")

    def _numbered(self, line: bytes, fields: list[str]) -> bytes:
        """A row, with the number of its part if the record is split."""
        if self._parts is None:
            return line + b"\n"
        assert self._time is not None
        t = float(fields[self._time])
        part = self._parts.of(t, again=self._again)
        if self._parts.later:
            fields[self._time] = repr(t + self._parts.later)
            line = ",".join(fields).encode()
        return line + b",%d\n" % part

    def _name(self, fields: list[str], line: bytes) -> None:
        self._header, self._begun = fields, line + b"\n"
        self._time = fields.index("t") if "t" in fields else None
        if self._parts is None:
            return
        if self._time is None or SEGMENT in fields:
            raise BadData(
                f"{self._place}: found the columns {','.join(fields)}, expected t, and no "
                f"{SEGMENT} yet; leave out --split"
            )
        self._begun = line + b"," + SEGMENT.encode() + b"\n"

    def _is_row(self, fields: list[str]) -> bool:
        if fields == self._header:
            return False
        if set(fields) & set(self._header) and not any(map(_is_number, fields)):
            raise BadData(
                f"{self._place}: found a source with the columns {','.join(fields)}, expected "
                f"{','.join(self._header)} as before; listen to it at another --port"
            )
        whole = len(fields) == len(self._header)
        if not whole or (self._time is not None and not _is_number(fields[self._time])):
            self.broken += 1
            return False
        self.count += 1
        if self._time is not None:
            before = self.losses.restarts
            self.losses.row(float(fields[self._time]), first=self._fresh)
            self._fresh, self._again = False, self.losses.restarts > before
        return True

    def told(self) -> str:
        """What is said at the end."""
        rows = f"{self.count:,} row{'s' if self.count != 1 else ''}"
        lost = self.losses.told() if self._time is not None else ""
        if self._parts and self._parts.later:
            lost += " and is counted on"
        lost = lost or "without a column t nobody can tell what was lost"
        broken = f"; {self.broken:,} cut short or broken, left out" if self.broken else ""
        return f"{rows}; {lost}{broken}"


def _fields(line: str) -> list[str]:
    return [field.strip() for field in next(csv.reader([line.rstrip("\r\n")]), [])]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


class Port(ByteSource):
    """The rows that come to a port; it ends by a signal, or after `idle` seconds without any.

    Several sources by TCP are read one beside the other, and one that was killed may come again.
    """

    def __init__(
        self,
        host: str,
        port: int,
        *,
        udp: bool,
        columns: str,
        idle: float | None,
        split: bool = False,
    ) -> None:
        place = f"{'udp' if udp else 'tcp'}://{host}:{port}"
        self._socket = _bound(host, port, place, udp=udp)
        super().__init__(self._socket.fileno(), place)
        self.rows = Rows(place, columns, split=split)
        self._idle, self._any = idle, False
        self._read = self._packets if udp else self._lines
        self._sources: dict[int, tuple[socket.socket, bytes]] = {}  # each with a part of a line

    def _fetch(self, size: int) -> bytes:  # noqa: ARG002 (rows are passed on whole)
        last = time.monotonic()
        while not STOP.over:
            left = None if self._idle is None else max(last + self._idle - time.monotonic(), 0.0)
            ready = STOP.wait(left, [*self._sources, self.fd])
            if found := b"".join(map(self.rows.passed, self._read(ready))):
                self._any = STOP.live = True
                return found
            if not ready and (STOP.number or left is not None):
                break
            last = time.monotonic()
        if not self._any:
            raise BadData(f"{self.name}: nothing came within {self._idle:g} s; is the source on?")
        return b""

    def _packets(self, ready: list[int]) -> Iterator[bytes]:
        for _ in range(AT_ONCE if ready else 0):
            try:
                yield from self._socket.recv(PACKET).splitlines()
            except BlockingIOError:
                return

    def _lines(self, ready: list[int]) -> Iterator[bytes]:
        """The whole lines that have come; a new source waits for what an old one has left."""
        old = [fd for fd in ready if fd in self._sources]
        for fd in old:
            yield from self._lines_of(fd)
        if ready and not old:
            source, _ = self._socket.accept()
            self._sources[source.fileno()] = (source, b"")
            self.rows.source_begins()

    def _lines_of(self, fd: int) -> Iterator[bytes]:
        source, held = self._sources.pop(fd)
        try:
            data = source.recv(CHUNK)
        except OSError:  # it was killed
            data = b""
        *lines, held = (held + data).split(b"\n")
        yield from lines
        if not data or len(held) > LONGEST:  # the end, which may have cut a row
            self.rows.broken += bool(held)
            held = b""
        if data:
            self._sources[fd] = (source, held)
        else:
            source.close()

    def told(self) -> str:
        """What is said at the end."""
        return self.rows.told()

    @property
    def regular(self) -> bool:
        """A port is no file."""
        return False

    def part_read(self) -> float | None:
        """Nobody knows what is still to come."""
        return None

    def close(self) -> None:
        """Close the port and its sources."""
        for source, _ in self._sources.values():
            source.close()
        self._socket.close()
        self.closed = True


def _bound(host: str, port: int, place: str, *, udp: bool) -> socket.socket:
    try:
        (family, kind, *_, address), *_ = socket.getaddrinfo(
            host, port, type=socket.SOCK_DGRAM if udp else socket.SOCK_STREAM
        )
    except (OSError, UnicodeError):
        raise UsageFault(f"--host {host}: no address of this machine") from None
    found = socket.socket(family, kind)
    try:
        if udp:
            found.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER)
            found.settimeout(0.0)
        else:  # a port whose last listener has just ended is free
            found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        found.bind(address)
        if not udp:
            found.listen()
    except OSError as error:
        found.close()
        taken = error.errno == errno.EADDRINUSE
        reason = "another program listens at this port" if taken else error.strerror
        raise OutputFailure(f"{place}: {reason}; give another --port or --host") from None
    return found
