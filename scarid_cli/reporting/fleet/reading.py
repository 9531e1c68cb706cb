"""Read the outcome of a batch: the tables fleet, estimates and robots."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from scarid_cli.io.table import Table
from scarid_cli.printable import printable

Row = dict[str, Any]

# What a log needs, the gravest first.
FAILED, CHANGED, DOUBTED, NOTICED, FINE = "failed", "changed", "doubted", "noticed", "fine"
STATES = {
    FAILED: "failed",
    CHANGED: "changed",
    DOUBTED: "verdict not good",
    NOTICED: "check not ok",
    FINE: "nothing found",
}


@dataclass(frozen=True)
class Fleet:
    """The rows of the three tables; a missing value is None.

    `logs` come with the failures first, `estimates` hold the rows of each robot and parameter in
    the order of the logs.
    """

    robots: tuple[Row, ...]
    logs: tuple[Row, ...]
    estimates: dict[tuple[str, str], tuple[Row, ...]]

    @property
    def joints(self) -> int:
        """The number of joints for which the table has a column."""
        names = self.logs[0] if self.logs else {}
        return sum(name.startswith("r2_") and name[3:].isdigit() for name in names)

    def parameters(self, robot: str) -> list[str]:
        """The parameters that were estimated for a robot, in the order of the table."""
        return [parameter for name, parameter in self.estimates if name == robot]


def fleet(logs: Table, estimates: Table, robots: Table) -> Fleet:
    """The outcome that these tables of a batch describe."""
    by_parameter: dict[tuple[str, str], list[Row]] = {}
    for row in rows(estimates):
        by_parameter.setdefault((row["robot"], row["parameter"]), []).append(row)
    places = list(STATES)
    found = sorted(rows(logs), key=lambda row: places.index(state(row)))
    ordered = {key: tuple(sorted(v, key=lambda r: r["order"])) for key, v in by_parameter.items()}
    return Fleet(tuple(rows(robots)), tuple(found), ordered)


def rows(table: Table) -> list[Row]:
    """The rows of a small table; texts without control characters, which may come from a log."""
    return [
        {k: printable(v) if isinstance(v, str) else v for k, v in row.items()}
        for batch in table.batches
        for row in batch.to_pylist()
    ]


def state(row: Row) -> str:
    """What a log needs: one of STATES."""
    if row["status"]:
        return FAILED
    if row.get("change") in ("changed", "unexplained") or row.get("compare") == "differs":
        return CHANGED
    if row.get("verdict") != "good":
        return DOUBTED
    return NOTICED if row.get("check") not in ("ok", None) else FINE


def differing(row: Row) -> tuple[str, ...]:
    """The parameters in which a log differs from the reference, the strongest first."""
    return tuple(filter(None, (row.get("differing") or "").split(", ")))


def remark(row: Row) -> str:
    """The one thing to know of a log: its error, else how it changed, else why it is doubtful."""
    found = state(row)
    if found == FAILED:
        return row.get("error") or f"exit status {row['status']}"
    if found == CHANGED and row.get("change") in ("changed", "unexplained"):
        return row.get("change_reason") or ""
    if found == CHANGED:
        return f"compare: {', '.join(differing(row))} differ from {row.get('reference')}"
    return (row.get("reasons") or "") if found == DOUBTED else row.get("findings") or ""
