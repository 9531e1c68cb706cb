"""The result of a check: its name, whether it passed, a figure, and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

OK, WARNING, FAILED = "ok", "warning", "failed"
TORQUES = "torques"  # the name of the check that knows limits only
STATUSES = (OK, WARNING, FAILED)  # from the best to the worst


@dataclass(frozen=True)
class Finding:
    """One line of a check; `advice` says what to do, and is empty where nothing has to be done."""

    name: str
    status: str
    figure: str
    advice: str = ""

    @property
    def text(self) -> str:
        """What was found and what to do, in a line."""
        return f"{self.name}: {self.figure}" + (f"; {self.advice}" if self.advice else "")


def worst(findings: Iterable[Finding]) -> str:
    """The worst status of these findings; ok if there are none."""
    return max((finding.status for finding in findings), key=STATUSES.index, default=OK)


def ok(name: str, figure: str) -> Finding:
    """A check that passed."""
    return Finding(name, OK, figure)


def warning(name: str, figure: str, advice: str) -> Finding:
    """A check that found something to look at before the run."""
    return Finding(name, WARNING, figure, advice)


def failed(name: str, figure: str, advice: str) -> Finding:
    """A check that found something that makes the run wrong or impossible."""
    return Finding(name, FAILED, figure, advice)


def joints_text(numbers: Iterable[int]) -> str:
    """`joint 2`, or `joints 1, 3`: joints by their numbers from 1."""
    listed = [str(number) for number in numbers]
    return f"joint{'s' if len(listed) > 1 else ''} {', '.join(listed)}"


def several(count: int, what: str) -> str:
    """`1 row`, `2 rows`."""
    return f"{count} {what}{'' if count == 1 else 's'}"
