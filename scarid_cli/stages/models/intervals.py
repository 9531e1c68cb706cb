"""The rows of a parameter table as exported models carry them: values with their 95 % intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, nan

from scarid_cli.arrays import Array
from scarid_cli.io.table import Table


@dataclass(frozen=True)
class Interval:
    """An identified parameter, and its 95 % interval (nan where there is none), in `unit`.

    `stands_for` is the combination of standard parameters, empty if it is alone.
    """

    name: str
    unit: str
    estimate: float
    low: float
    high: float
    stands_for: str = ""

    @property
    def known(self) -> bool:
        """Whether there is an interval."""
        return isfinite(self.low) and isfinite(self.high)

    @property
    def text(self) -> str:
        """The interval in words."""
        return f"{self.low:.6g} to {self.high:.6g}" if self.known else "no interval"


def intervals(table: Table) -> list[Interval]:
    """The rows of a table of `identify`, or of one with estimates alone."""
    return [
        Interval(
            row["parameter"],
            row["unit"],
            float(row["estimate"]),
            _number(row.get("low")),
            _number(row.get("high")),
            row.get("stands_for") or "",
        )
        for batch in table.batches
        for row in batch.to_pylist()
    ]


def _number(value: float | None) -> float:
    return nan if value is None else float(value)


def listed(rows: Sequence[Interval], base: Array | None = None) -> list[str]:
    """The rows as lines of text, beside the values of the bodies if these are others (`base`)."""
    title = ["parameter", "unit", *(["here"] if base is not None else []), "identified", "95 %"]
    table = [title]
    for i, row in enumerate(rows):
        own = [row.name, row.unit]
        if base is not None:
            own.append(f"{base[i]:.6g}" if i < len(base) else "")
        combination = "" if row.stands_for in ("", row.name) else f"  = {row.stands_for}"
        table.append([*own, f"{row.estimate:.6g}", f"{row.text}{combination}"])
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return ["  ".join(x.ljust(w) for x, w in zip(row, widths, strict=True)).rstrip()
            for row in table]  # fmt: skip
