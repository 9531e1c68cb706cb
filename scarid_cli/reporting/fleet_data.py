"""The table of logs for the script of the fleet page: compact JSON, a list for each column."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from math import isfinite
from typing import Any
from urllib.parse import quote

import numpy as np
from markupsafe import Markup

from scarid_cli.arrays import Array
from scarid_cli.reporting.fleet import FleetRobot, Log
from scarid_cli.reporting.fleet_history import History

# Characters that could end the element or begin another one; JSON allows their codes in strings.
CODES = {ord(c): f"\\u{ord(c):04x}" for c in "<>&"}


def embedded(robots: Sequence[FleetRobot], base: str) -> Markup:
    """The document to put between the tags of a script element.

    `base` is the path from the page to the folder of the fleet.
    """
    document = {
        "robots": [_robot(robot) for robot in robots],
        "logs": _columns(_log(i, log, base) for i, robot in enumerate(robots) for log in robot.logs)
        | {"apart": [x for robot in robots for x in _apart(robot)]},
    }
    text = json.dumps(document, separators=(",", ":"), allow_nan=False)
    return Markup(text.translate(CODES))


def href(base: str, path: str) -> str:
    """A relative address for a path, whatever characters it has."""
    return quote(f"{base}/{path}", safe="/")


def _robot(robot: FleetRobot) -> dict[str, Any]:
    return {
        "name": robot.name,
        "logs": max((log["order"] for log in robot.logs), default=0),
        "reference": robot.values.get("reference"),
        "trending": robot.trending,
        "parameters": [_history(history) for history in robot.shown],
    }


def _history(history: History) -> dict[str, Any]:
    """Whole numbers of the unit's last decimal place that matters."""
    scale = 10.0**history.decimals

    def whole(values: Array) -> list[int]:
        return [int(x) for x in np.round(values * scale)]

    return {
        "name": history.parameter,
        "unit": history.unit,
        "decimals": history.decimals,
        "limits": whole(np.array(history.limits)),
        "order": history.order.tolist(),
        "estimate": whole(history.estimate),
        "half": whole(history.half),
    }


def _log(robot: int, log: Log, base: str) -> dict[str, Any]:
    """The values of one row, as its columns are named in the script."""
    return {
        "robot": robot,
        "log": log["log"],
        "date": log["date"],
        "order": log["order"],
        "place": log.place,
        "marks": log.marks,
        "notes": log.notes,
        "check": log["check"],
        "verdict": log["verdict"],
        "differing": log.differing,
        "reference": log["reference"],
        "r2": [_rounded(x, 4) for x in log.r2],
        "validated": [_rounded(x, 4) for x in log.r2_validated],
        "delay": _rounded(log["delay"], 6),
        "error": _rounded(log["delay_error"], 6),
        "condition": _rounded(log["condition_number"], 0),
        "samples": log["samples"],
        "page": href(base, log["page"]) if log["page"] else None,
    }


def _columns(rows: Iterable[dict[str, Any]]) -> dict[str, list[Any]]:
    """Rows as columns."""
    columns: dict[str, list[Any]] = {}
    for row in rows:
        for name, value in row.items():
            columns.setdefault(name, []).append(value)
    return columns


def _apart(robot: FleetRobot) -> list[float | None]:
    """The largest difference of each log to the reference [standard errors]."""
    largest: dict[int, float] = {}
    for history in robot.shown:
        for order, errors in zip(history.order.tolist(), history.errors.tolist(), strict=True):
            if isfinite(errors):
                largest[order] = max(abs(errors), largest.get(order, 0.0))
    return [_rounded(largest.get(log["order"]), 1) for log in robot.logs]


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None or not isfinite(value) else round(value, digits)
