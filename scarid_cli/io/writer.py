"""Where a table goes: standard output, or a file that appears only when it is complete."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from scarid_cli.errors import OutputFailure, UsageFault
from scarid_cli.io import FORMATS
from scarid_cli.io.stop import STOP
from scarid_cli.io.table import Table
from scarid_cli.io.target import Target, is_regular
from scarid_cli.printable import utf8

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


class Writer(Protocol):
    def write(self, batch: pa.RecordBatch) -> None: ...
    def close(self) -> None: ...
    def abort(self) -> None: ...


def format_for(path: str, wanted: str | None) -> str:
    """The format to write: as given, else that of the extension, else of the environment."""
    if Path(path).name.lower() in EXTENSIONS:  # as from -o "$NAME.csv" where NAME is not set
        raise UsageFault(f"{path}: an extension without a name; give the file a name before it")
    chosen = wanted or EXTENSIONS.get(Path(path).suffix.lower())
    if not chosen and path != "-" and Path(path).suffix and is_regular(Path(path)):
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


class Committable:
    """What goes to a target, whose file appears, or is taken back, together with all others."""

    target: Target

    @property
    def is_file(self) -> bool:
        """Whether it goes to a file, which can be taken back."""
        return self.target.is_file

    def commit(self, *, keep: bool) -> None:
        """Put the file in its place, and keep what was there before until all is settled."""
        self.target.commit(keep=keep)

    def settle(self) -> None:
        """All outputs are complete."""
        self.target.settle()


class Output(Committable):
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

    @property
    def is_file(self) -> bool:
        """There is no file."""
        return False

    def settle(self) -> None:
        """There is nothing to close."""

    def abort(self) -> None:
        """The next stage has aborted its own output."""


class Document(Committable):
    """A document beside the tables."""

    def __init__(self, path: str) -> None:
        self.path = path
        self.target = Target(path)

    def write(self, content: str | bytes) -> None:
        self.target.write(content if isinstance(content, bytes) else utf8(content).encode())

    def finish(self) -> None:
        """A document has no end mark."""

    def abort(self) -> None:
        self.target.discard()


class InFolder(Document):
    """A document in a folder that is made if need be, and does not stay empty."""

    def __init__(self, path: str) -> None:
        self._folder = Path(path).parent
        self._made = not self._folder.exists()
        self._folder.mkdir(parents=True, exist_ok=True)
        super().__init__(path)

    def abort(self) -> None:
        super().abort()
        if self._made:
            with contextlib.suppress(OSError):  # there is something else in it
                self._folder.rmdir()


def _writer(name: str) -> Any:
    if name == "csv":
        from scarid_cli.io.csvio import CsvWriter

        return CsvWriter
    from scarid_cli.io import outgoing

    return {
        "parquet": outgoing.ParquetWriter,
        "arrow": outgoing.StreamWriter,
        "arrow-file": outgoing.FileWriter,
    }[name]


@contextlib.contextmanager
def all_or_none(outputs: list[Output | Document]) -> Iterator[None]:
    """Finish all outputs when the block ends, or abort all of them when it fails.

    Files come first: they can be taken back, but not the end mark of a table in a pipe.
    """
    try:
        yield
        STOP.require_not_lost()
        files = [output for output in outputs if output.is_file]
        for output in files:
            output.finish()
        for output in files:
            with STOP.postponed():
                output.commit(keep=len(outputs) > 1)
        for output in outputs:
            if output not in files:
                output.finish()
        with STOP.postponed():
            for output in outputs:
                output.settle()
    except BaseException:
        with STOP.postponed():
            for output in reversed(outputs):
                output.abort()
        raise
