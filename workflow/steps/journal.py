"""What a job has found so far: one that was killed goes on after the last log that it finished.

Snakemake removes the declared outputs of a job that was killed before it starts the job again; the
journal, and what belongs to it, is not declared.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from steps.commands import Result
from steps.plan import Log

from scarid_cli import __version__


class Journal:
    """The results of the logs of a group, in a folder with what else the job has made so far.

    It counts for the same `inputs` only: texts, and files by their content. A log counts while its
    file has the same size and time.
    """

    def __init__(self, folder: Path, inputs: Iterable[str | Path]) -> None:
        self.folder = folder
        self._file = folder / "journal.jsonl"
        digest = hashlib.sha256(__version__.encode())
        for given in inputs:
            content = given.read_bytes() if isinstance(given, Path) else given.encode()
            digest.update(hashlib.sha256(content).digest())
        self._key = digest.hexdigest()
        lines = list(self._lines())
        if not lines or lines[0] != [self._key]:
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            self._add([self._key])
            lines = []
        self._known = {tuple(stamp): (result, files) for stamp, result, files in lines[1:]}

    def resumed(
        self,
        log: Log,
        step: Callable[[Log], Result],
        made: Sequence[Path],
        declared: Sequence[Path],
    ) -> Result:
        """The result of a step on a log: that of before if it is known, else the step's.

        The step may have `made` these files, which must still be there. Those that are `declared`
        to Snakemake have another name in the journal, from where they come back.
        """
        stamp = _stamp(log)
        kept = [
            (self.folder / str(k) / f"{log.name}.kept", path) for k, path in enumerate(declared)
        ]
        if stamp in self._known:
            result, files = self._known[stamp]
            for own, path in kept:
                _link(own, path)
            if all(Path(file).exists() for file in files):
                return result
        result = step(log)
        for own, path in kept:
            _link(path, own)
        self._add([stamp, result, [str(path) for path in (*made, *declared) if path.exists()]])
        return result

    def close(self) -> None:
        """Remove the journal: the job is done."""
        shutil.rmtree(self.folder)

    def _lines(self) -> Iterator[list[Any]]:
        """The lines that are complete."""
        text = self._file.read_text("utf-8") if self._file.exists() else ""
        for line in text.splitlines(keepends=True):
            if not line.endswith("\n"):
                self._file.write_text(text.removesuffix(line), "utf-8")
                return
            yield json.loads(line)

    def _add(self, entry: object) -> None:
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry) + "\n")


def _link(path: Path, other: Path) -> None:
    """Give a file, if it exists, another name as well."""
    if path.exists():
        other.parent.mkdir(parents=True, exist_ok=True)
        other.unlink(missing_ok=True)
        try:
            os.link(path, other)
        except OSError:  # a file system without links
            shutil.copy2(path, other)


def _stamp(log: Log) -> tuple[str, int, int]:
    """What a log's result is valid for: its name, the size of its file, and its time [ns]."""
    state = Path(log.file).stat()
    return log.name, state.st_size, state.st_mtime_ns
