"""The place of an output: a file that appears only when it is complete, or a stream."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
import re
import stat
import sys
import time
from pathlib import Path
from typing import Any

from scarid_cli.errors import OutputFailure
from scarid_cli.printable import printable

STDOUT = "<stdout>"
# Ends of names: of a file that is being written, and of the one that it replaces.
PART, BEFORE = ".part", ".before"
YOUNG = 60.0  # s
STEM = 100  # bytes of the name of an output that those of its parts begin with
MADE = re.compile(r"[0-9a-f]{12}\.(part|before)")  # the end of such a name
PIPE = 1 << 20  # bytes in a pipe at most


class Target:
    """Where bytes go. A regular file is written under another name and renamed at the end.

    The file that a symbolic link leads to is replaced, not the link, and keeps its mode.
    """

    def __init__(self, path: str) -> None:
        self.name = STDOUT if path == "-" else path
        if path.endswith(os.sep):
            raise OutputFailure(f"{path}: a folder; name a file in it")
        self._part: Path | None = None
        self._before: Path | None = None  # what was there before, under another name
        self._put = False  # whether the file is in its place
        self._place = Path(os.path.realpath(path))
        if path == "-":
            self._fd = 1
        elif _is_stdout(path):
            self._fd = os.dup(1)
        elif is_regular(self._place):
            self._part = self._place.with_name(_part_name(self._place.name))
            # Exclusive: a file or link that somebody has put there is never written to.
            self._fd = self._open(self._part, os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW)
            self._take_mode()
        else:
            self._fd = self._open(self._place)
        _widen(self._fd)

    def _take_mode(self) -> None:
        """Give the part the mode of the file that it replaces, before anything is in it."""
        with contextlib.suppress(OSError):
            os.fchmod(self._fd, stat.S_IMODE(self._place.stat().st_mode))

    def _remove_abandoned(self) -> None:
        """Remove what runs to the same output have left that were killed, and tell it."""
        with contextlib.suppress(OSError):
            for name in os.listdir(self._place.parent):  # noqa: PTH208 (no paths are needed)
                if _abandoned(self._place.with_name(name), _start(self._place.name)):
                    self._place.with_name(name).unlink()
                    text = printable(f"scarid: removed {name}, left by a run that was killed")
                    print(text, file=sys.stderr)  # noqa: T201

    def _open(self, path: Path, flags: int = 0) -> int:
        try:
            return os.open(path, os.O_WRONLY | os.O_CLOEXEC | flags, 0o666)
        except FileNotFoundError:
            link = Path(self.name).is_symlink()
            folder = self._place.parent if link else Path(self.name).parent
            raise OutputFailure(
                f"{self.name}: there is no folder {folder}; make it first"
            ) from None
        except OSError as error:
            raise OutputFailure(f"{self.name}: {error.strerror}") from None

    def write(self, data: Any) -> None:
        view = memoryview(data).cast("B") if len(data) else memoryview(b"")
        try:
            while view:
                view = view[os.write(self._fd, view) :]
        except BrokenPipeError:
            raise
        except OSError as error:
            raise self._failure(error) from None

    @property
    def is_file(self) -> bool:
        """Whether this is a regular file, which can be put in its place and taken back."""
        return self._part is not None or self._put

    def commit(self, *, keep: bool) -> None:
        """Put the file in its place; `keep` what was there before, until all is settled."""
        assert self._part
        try:
            self._close()
            if keep and self._place.exists():
                self._before = self._part.with_suffix(BEFORE)
                self._before.hardlink_to(self._place)
            self._part.replace(self._place)
        except OSError as error:
            raise self._failure(error) from None
        self._part, self._put = None, True

    def settle(self) -> None:
        """All outputs are complete and in their places."""
        try:
            self._close()
        except OSError as error:
            raise self._failure(error) from None
        if self._put:
            self._remove_abandoned()
        self._forget()

    def discard(self) -> None:
        """Leave nothing behind, but what was there before."""
        with contextlib.suppress(OSError):
            self._close()
        with contextlib.suppress(OSError):
            if self._part:
                self._part.unlink(missing_ok=True)
            elif self._put and self._before:
                self._before.replace(self._place)
            elif self._put:
                self._place.unlink()
        self._forget()

    def _forget(self) -> None:
        if self._before:
            self._before.unlink(missing_ok=True)
        self._put, self._before = False, None

    def _close(self) -> None:
        if self._fd > 1:
            fd, self._fd = self._fd, -1
            os.close(fd)

    def _failure(self, error: OSError) -> OutputFailure:
        closed = self._fd == 1 and error.errno == errno.EBADF
        reason = "standard output is closed" if closed else error.strerror
        left = "nothing was written" if self._part or closed else "the output is incomplete"
        return OutputFailure(f"{self.name}: {reason}; {left}")


def same_place(one: str, other: str) -> bool:
    """Whether two paths, or - for standard output, are spellings of one place."""
    return _place_of(one) == _place_of(other)


def _place_of(path: str) -> object:
    """What tells places apart: the file itself if there is one (not its name), else its path."""
    real = os.path.realpath(path)
    with contextlib.suppress(OSError):
        found = os.fstat(1) if path == "-" or _is_stdout(path) else os.stat(real)  # noqa: PTH116
        if not stat.S_ISCHR(found.st_mode) or path == "-":  # /dev/null takes any number of them
            return found.st_dev, found.st_ino
    return object() if Path(real).is_char_device() else real


def _widen(fd: int) -> None:
    """Let a pipe hold a whole batch of rows, where the system allows it (Linux)."""
    with contextlib.suppress(OSError, AttributeError):
        fcntl.fcntl(fd, fcntl.F_SETPIPE_SZ, PIPE)


def _is_stdout(path: str) -> bool:
    return path in ("/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")


def _start(name: str) -> str:
    """How the parts of an output begin: with its name, shortened so that their names can be."""
    short = name.encode(errors="surrogateescape")[:STEM].decode(errors="ignore")
    return f".{short}."


def _part_name(name: str) -> str:
    """A name that nobody can guess, with the number of the process that makes it."""
    return f"{_start(name)}{os.getpid()}.{os.urandom(6).hex()}{PART}"


def _abandoned(part: Path, start: str) -> bool:
    """Whether this is a part of an output of a run that is gone.

    A young part may be that of a run on another machine, whose processes are not known here.
    """
    name = part.name
    if not name.startswith(start) or not name.endswith((PART, BEFORE)):
        return False
    number, _, rest = name[len(start) :].partition(".")
    if not MADE.fullmatch(rest) or not number.isdecimal() or _runs(int(number)):
        return False
    return time.time() - part.stat().st_mtime > YOUNG


def _runs(process: int) -> bool:
    """Whether there is a process with this number."""
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        pass
    return True


def is_regular(path: Path) -> bool:
    """Whether this is a regular file, or will be one."""
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return True
