"""What `validate` and `compare` have said of a robot: whether it has changed, and against what."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from scarid_cli.algorithms.changes.wording import CHANGED, UNCHANGED, UNEXPLAINED
from scarid_cli.io.table import Metadata
from scarid_cli.printable import printable
from scarid_cli.reporting.naming import of_a_folder
from scarid_cli.stages.compare import DIFFER, SAME

FINE = (UNCHANGED, SAME)
ALARMING = (CHANGED, DIFFER, UNEXPLAINED)  # the worst first
PARAMETERS = "--parameters"
MAKERS = ("trajgen", "simulate")  # what they read is no log


@dataclass(frozen=True)
class Said:
    """A verdict and its reason; `what` it is on, and `against` which parameters, for a person."""

    verdict: str
    reason: str
    what: str
    against: str

    @property
    def title(self) -> str:
        return f"{self.what} beside {self.against}" if self.against else self.what


def files_of(meta: Metadata) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The logs, as they were recorded, and the parameter tables that predicted their torques.

    The logs are those that the first command of the history read, the parameters those of the last
    one, `validate`. Both are empty where the table has no history.
    """
    if not meta.history:
        return (), ()
    words = shlex.split(meta.history[-1]["command"])
    by = [after for word, after in pairwise(words) if word == PARAMETERS]
    for entry in meta.history:
        if entry["command"].split()[1] in MAKERS:
            continue
        logs = [f for f in entry["inputs"] if f not in by and not f.endswith((".toml", ".urdf"))]
        if logs and logs != ["-"]:
            return tuple(logs), tuple(by)
    return (), tuple(by)


def same_table(one: str, other: str) -> bool:
    """Whether two paths may be of one file, as seen from different folders."""
    pair = zip(reversed(Path(one).parts), reversed(Path(other).parts), strict=False)
    return all(a == b for a, b in pair if a not in ("..", "."))


def of_validation(meta: Metadata, label: str) -> Said | None:
    """What `validate` said, if it could say anything."""
    change: dict[str, Any] = meta.extra.get("change") or {}
    if not change:
        return None
    logs, by = files_of(meta)
    what = named(logs) or label
    return Said(change["verdict"], printable(change["reason"]), what, named(by))


def of_comparison(meta: Metadata, label: str) -> tuple[Said, ...]:
    """What `compare` said of each table beside the first one."""
    first = shlex.split(meta.history[-1]["command"])[2:3] if meta.history else []
    return tuple(
        Said(
            DIFFER if pair["differ"] else SAME,
            printable(pair["reason"]),
            named([pair["table"]]) or label,
            named(first),
        )
        for pair in meta.extra.get("comparisons", ())
    )


def named(files: Sequence[str]) -> str:
    """Files by their own names: `monday.csv and tuesday.csv`; of many, the first and the number."""
    names = [printable(_own_name(Path(file))) for file in files if file != "-"]
    if len(names) > 2:
        return f"{names[0]} and {len(names) - 1} others"
    return " and ".join(names)


def _own_name(path: Path) -> str:
    """The name of a file, or that of its folder where all folders hold a file of this name."""
    return path.parent.name if of_a_folder(path) else path.name


def worst(said: Sequence[Said]) -> Said | None:
    """The first of the most alarming verdicts; None if all are fine."""
    found = [one for one in said if one.verdict in ALARMING]
    return min(found, key=lambda one: ALARMING.index(one.verdict), default=None)
