"""Where a table goes: standard output, or a file that appears only when it is complete."""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from scarid_cli.errors import OutputFailure, UsageFault
from scarid_cli.io import FORMATS
from scarid_cli.io.table import Table
from scarid_cli.printable import printable

if TYPE_CHECKING:
    import pyarrow as pa


EXTENSIONS = {
    ".csv": "csv",
    ".parquet": "parquet",
    ".pq": "parquet",
    ".arrows": "arrow",
    ".arrow": "arrow-file",
    ".feather": "arrow-file",
}
STDOUT = "<stdout>"
YOUNG = 60.0  # s


class Writer(Protocol):
    def write(self, batch: pa.RecordBatch) -> None: ...
    def close(self) -> None: ...
    def abort(self) -> None: ...


class Target:
    """Where bytes go. A regular file is written under another name and renamed at the end.

    The file that a symbolic link leads to is replaced, not the link, and keeps its mode.
    """

    def __init__(self, path: str) -> None:
        self.name = STDOUT if path == "-" else path
        self._part: Path | None = None
        self._place = Path(os.path.realpath(path))
        if path == "-":
            self._fd = 1
        elif _is_stdout(path):
            self._fd = os.dup(1)
        elif _regular(self._place):
            self._remove_abandoned()
            self._part = self._place.with_name(f".{self._place.name}.{os.getpid()}.part")
            self._fd = self._open(self._part, os.O_CREAT | os.O_TRUNC)
        else:
            self._fd = self._open(self._place)

    def _remove_abandoned(self) -> None:
        """Remove what runs to the same output have left that were killed, and tell it."""
        with contextlib.suppress(OSError):
            for name in os.listdir(self._place.parent):  # noqa: PTH208 (no paths are needed)
                if _abandoned(self._place.with_name(name), f".{self._place.name}."):
                    self._place.with_name(name).unlink()
                    text = printable(f"scarid: removed {name}, left by a run that was killed")
                    print(text, file=sys.stderr)  # noqa: T201

    def _open(self, path: Path, flags: int = 0) -> int:
        try:
            return os.open(path, os.O_WRONLY | os.O_CLOEXEC | flags, 0o666)
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

    def commit(self) -> None:
        """Put the file in its place."""
        try:
            self._close()
            if self._part:
                with contextlib.suppress(FileNotFoundError):
                    self._part.chmod(stat.S_IMODE(self._place.stat().st_mode))
                self._part.replace(self._place)
        except OSError as error:
            self.discard()
            raise self._failure(error) from None
        self._part = None

    def discard(self) -> None:
        """Leave nothing behind."""
        with contextlib.suppress(OSError):
            self._close()
        if self._part:
            self._part.unlink(missing_ok=True)

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


def _is_stdout(path: str) -> bool:
    return path in ("/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")


def _abandoned(part: Path, start: str) -> bool:
    """Whether this is a part of an output of a run that is gone.

    A young part may be that of a run on another machine, whose processes are not known here.
    """
    name = part.name
    number = name.removeprefix(start).removesuffix(".part")
    if name != f"{start}{number}.part" or not number.isdecimal() or _runs(int(number)):
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


def _regular(path: Path) -> bool:
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except OSError:
        return True


def format_for(path: str, wanted: str | None) -> str:
    """The format to write: as given, else that of the extension, else of the environment."""
    if Path(path).name.lower() in EXTENSIONS:  # as from -o "$NAME.csv" where NAME is not set
        raise UsageFault(f"{path}: an extension without a name; give the file a name before it")
    chosen = wanted or EXTENSIONS.get(Path(path).suffix.lower())
    if not chosen and path != "-" and Path(path).suffix and _regular(Path(path)):
        known = " ".join(EXTENSIONS)
        raise UsageFault(f"{path}: unknown extension; use one of {known}, or give --format")
    chosen = chosen or os.environ.get("SCARID_FORMAT") or "csv"
    if chosen not in FORMATS:
        raise UsageFault(f"SCARID_FORMAT={chosen}: unknown format; use one of {' '.join(FORMATS)}")
    if chosen != "csv" and path == "-" and os.isatty(1):
        raise UsageFault(
            f"{chosen} is binary and the output is a terminal; redirect it, or use -o FILE"
        )
    return chosen


class Output:
    """One table to write; made before the input is read, so that mistakes show at once."""

    def __init__(self, path: str, wanted: str | None = None) -> None:
        self.path = path
        self.format = format_for(path, wanted)
        self.target = Target(path)
        self._writer: Writer | None = None

    def start(self, schema: pa.Schema) -> None:
        """Write what precedes the first row."""
        self._writer = _writer(self.format)(self.target.write, schema)

    def write(self, batch: pa.RecordBatch) -> None:
        assert self._writer is not None
        self._writer.write(batch)

    def take(self, table: Table) -> None:
        """Write every batch of a table."""
        self.start(table.arrow_schema())
        for batch in table.batches:
            self.write(batch)
        self.whole()

    def whole(self) -> None:
        """All rows are written, but the run may still fail."""

    def finish(self) -> None:
        """The table is complete: write the end mark."""
        if self._writer:
            self._writer.close()
            self._writer = None

    def commit(self) -> None:
        """Put the file in its place."""
        self.target.commit()

    def abort(self) -> None:
        """The table is incomplete, and must not look complete."""
        if self._writer:
            with contextlib.suppress(OSError, OutputFailure):
                self._writer.abort()
        self.target.discard()


class Handover(Output):
    """The place of standard output before `then`: the next stage takes the table itself."""

    def __init__(self, following: Callable[[Table], None]) -> None:
        self.path = "-"
        self.format = "arrow"  # like which it keeps the metadata
        self._following = following

    def take(self, table: Table) -> None:
        """Let the next stage pull the rows."""
        self._following(table)

    def finish(self) -> None:
        """The next stage has finished its own output."""

    def commit(self) -> None:
        """There is no file."""

    def abort(self) -> None:
        """The next stage has aborted its own output."""


class Document:
    """A document beside the tables."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.target = Target(path)

    def write(self, content: str | bytes) -> None:
        self.target.write(content if isinstance(content, bytes) else content.encode())

    def finish(self) -> None:
        """A document has no end mark."""

    def commit(self) -> None:
        """Put the file in its place."""
        self.target.commit()

    def abort(self) -> None:
        self.target.discard()


def _writer(name: str) -> Any:
    if name == "csv":
        from scarid_cli.io.csvio import CsvWriter

        return CsvWriter
    from scarid_cli.io import arrowio

    return {
        "parquet": arrowio.ParquetWriter,
        "arrow": arrowio.StreamWriter,
        "arrow-file": arrowio.FileWriter,
    }[name]


@contextlib.contextmanager
def all_or_none(outputs: list[Output | Document]) -> Iterator[None]:
    """Finish all outputs when the block ends, or abort all of them when it fails."""
    try:
        yield
        for output in outputs:
            output.finish()
        for output in outputs:
            output.commit()
    except BaseException:
        for output in outputs:
            output.abort()
        raise
