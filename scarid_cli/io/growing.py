"""The rows of a CSV file that another program still writes, as they come: like `tail -F`."""

from __future__ import annotations

import os
import time
from pathlib import Path

from scarid_cli.errors import BadData, OutputFailure, UsageFault
from scarid_cli.io.bytesource import CHUNK, ByteSource
from scarid_cli.io.listening import LONGEST, Rows
from scarid_cli.io.stop import STOP

LOOK = 0.02  # s between looks at the file


class Growing(ByteSource):
    """The whole lines of a file, from its start; it ends by a signal, or after `idle` seconds.

    A file that was cut, or that another one has taken the place of, is read from its start: its
    time may begin again, and its repeated header is no row.
    """

    def __init__(self, path: str, *, columns: str, idle: float | None, split: bool = False) -> None:
        self._path = path
        super().__init__(_opened(path), path)
        self.rows = Rows(path, columns, split=split)
        self.begun = 0  # times that the file was read anew
        self._idle, self._held = idle, b""
        self._any = False
        STOP.live = True  # a signal ends the table, and not the run

    def _fetch(self, size: int) -> bytes:  # noqa: ARG002 (rows are passed on whole)
        last = time.monotonic()
        while True:
            data = os.read(self.fd, CHUNK)
            *lines, self._held = (self._held + data).split(b"\n")
            if found := b"".join(map(self.rows.passed, lines)):
                self._any = True
                return found
            if data:
                last = time.monotonic()
            elif STOP.number or (self._idle is not None and time.monotonic() - last > self._idle):
                break
            elif not self._replaced():
                STOP.wait(LOOK, [])
            if len(self._held) > LONGEST:
                raise BadData(f"{self.name}: found a line of {LONGEST} bytes, expected rows of CSV")
        self.rows.broken += bool(self._held)
        if not self._any:
            raise BadData(f"{self.name}: no row came; is the program on that writes it?")
        return b""

    def _replaced(self) -> bool:
        """Whether the file has to be read anew from its start, which is then so."""
        here = os.fstat(self.fd)
        try:
            there = Path(self._path).stat()
        except OSError:  # between two files
            return False
        other = not os.path.samestat(here, there)
        if not other and here.st_size >= os.lseek(self.fd, 0, os.SEEK_CUR):
            return False
        if other:
            fd = _opened(self._path)
            os.close(self.fd)
            self.fd = fd
        os.lseek(self.fd, 0, os.SEEK_SET)
        self.rows.broken += bool(self._held)
        self._held = b""
        self.begun += 1
        self.rows.source_begins()
        return True

    @property
    def regular(self) -> bool:
        """What still grows is no file whose length is known."""
        return False

    def part_read(self) -> float | None:
        """Nobody knows what is still to come."""
        return None

    def told(self) -> str:
        """What is said at the end."""
        anew = f"; read anew {self.begun} times" if self.begun > 1 else "; read anew once"
        return self.rows.told() + (anew if self.begun else "")


def _opened(path: str) -> int:
    try:
        return os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    except FileNotFoundError:
        raise UsageFault(f"{path}: no such file") from None
    except OSError as error:
        raise OutputFailure(f"{path}: {error.strerror}") from None
