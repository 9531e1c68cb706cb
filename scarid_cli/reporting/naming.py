"""The labels of a report, from file names: METHOD.EXPERIMENT.KIND.EXTENSION."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from scarid_cli.io.bytesource import STDIN
from scarid_cli.printable import printable

COMMON = "common"  # the one motion of a log with which all methods are compared


@dataclass(frozen=True)
class Name:
    """What a table holds the results of: `label` is the method, `experiment` may be empty.

    `published` marks values that were printed in an article.
    """

    label: str
    experiment: str
    published: bool = False

    @property
    def shown(self) -> str:
        return f"{self.label}, published" if self.published else self.label


def name_of(file: str, kind: str) -> Name:
    """`p2smd.direct.metrics.parquet`: method p2smd, experiment direct; `p2smd.csv`: none."""
    if file == STDIN:
        return Name("stdin", "")
    path = Path(file)
    if of_a_folder(path):
        return Name(printable(path.parent.name), "")
    last = printable(path.name)
    label, *middle = last.split(".")
    middle = middle[:-1]
    if middle and middle[-1].rstrip("s") == kind.rstrip("s"):
        middle.pop()
    return Name(label or last, ".".join(middle))


def of_a_folder(path: Path) -> bool:
    """Whether the folder has the name of the log, as in the outcome of a batch: logs/ROBOT/LOG."""
    return path.parts[-4:-3] == ("logs",)


def names_of(files: Sequence[str], kinds: Sequence[str]) -> list[Name]:
    """The names of all tables; equal labels are distinguished by folder, then by file."""
    names = [name_of(file, kind) for file, kind in zip(files, kinds, strict=True)]
    for in_full in (False, True):
        counts = Counter(zip(kinds, names, strict=True))
        clashing = {name.label for (_, name), count in counts.items() if count > 1}
        names = [
            _with_path(name, file, in_full=in_full) if name.label in clashing else name
            for name, file in zip(names, files, strict=True)
        ]
    return names


def _with_path(name: Name, file: str, *, in_full: bool) -> Name:
    path = file if in_full else str(Path(file).with_name(name.label))
    return replace(name, label=printable(path))


def figures(titles: Sequence[str], drawn: Sequence[Sequence[str]]) -> list[tuple[str, str]]:
    """A file name for each figure: its number, its section, and its place in the section."""
    named: list[tuple[str, str]] = []
    for title, documents in zip(titles, drawn, strict=True):
        words = re.findall(r"[a-z0-9]+", title.lower())
        for place, document in enumerate(documents, start=1):
            named.append((f"{len(named) + 1:02}-{'-'.join(words)}-{place}.svg", document))
    return named
