"""The rows of the page's table: texts, ready to be shown, sorted, filtered and saved."""

from __future__ import annotations

import json
from dataclasses import dataclass
from math import isfinite
from typing import Any
from urllib.parse import quote

from scarid_cli.reporting.fleet.reading import Fleet, Row, differing, remark, state

HEADERS = (
    *("robot", "log", "date", "check", "verdict", "change"),
    *("R2", "delay [ms]", "remark", "parameters"),
)
NUMERIC = ("R2", "delay [ms]")
NAMED = 3  # parameters in a row
PLACES = 4  # of an R2


@dataclass(frozen=True)
class Entry:
    """A row: what it needs, its cells, the link to its own page ("" if none), and details."""

    state: str
    cells: tuple[str, ...]
    link: str
    details: tuple[tuple[str, str], ...]


def entries(fleet: Fleet, prefix: str) -> list[Entry]:
    """The rows in the order of the fleet; `prefix` is the way from the page to its folder."""
    estimates: dict[tuple[str, str], list[Row]] = {}
    for rows in fleet.estimates.values():
        for row in rows:
            estimates.setdefault((row["robot"], row["log"]), []).append(row)
    joints = fleet.joints
    return [
        _entry(row, estimates.get((row["robot"], row["log"]), []), joints, prefix)
        for row in fleet.logs
    ]


def _entry(row: Row, estimates: list[Row], joints: int, prefix: str) -> Entry:
    apart = differing(row)
    first = sorted(estimates, key=lambda e: e["parameter"] not in apart)
    named = [_estimate(e) for e in first[:NAMED]]
    page = row.get("page")
    cells = (
        *(row["robot"], row["log"], _text(row, "date"), _text(row, "check")),
        *(_text(row, "verdict"), _change(row), _r2(row, "r2", joints), _delay(row)),
        *(remark(row), "; ".join(named)),
    )
    link = prefix + quote(page) if page else ""
    return Entry(state(row), cells, link, tuple(_details(row, first, joints)))


def _details(row: Row, estimates: list[Row], joints: int) -> list[tuple[str, str]]:
    """What a row shows when it is opened; the parameters that differ come first."""
    texts = {
        "file": row.get("file"),
        "error": row.get("error"),
        "findings of check": row.get("findings"),
        "reasons of the verdict": row.get("reasons"),
        "change": None if row.get("change") == "unchanged" else row.get("change_reason"),
        "compared with": row.get("reference"),
        "parameters that differ": row.get("differing"),
        "R2 by the reference": _r2(row, "r2_validated", joints),
        "estimates": "; ".join(map(_estimate, estimates)),
    }
    return [(name, text) for name, text in texts.items() if text]


def _text(row: Row, name: str) -> str:
    return row.get(name) or ""


def _change(row: Row) -> str:
    """What validate says, and compare where it says otherwise."""
    change = _text(row, "change")
    return "differs" if change in ("", "unchanged") and row.get("compare") == "differs" else change


def _r2(row: Row, name: str, joints: int) -> str:
    values = (row.get(f"{name}_{i}") for i in range(1, joints + 1))
    return " ".join(f"{v:.{PLACES}f}" for v in values if v is not None and isfinite(v))


def _delay(row: Row) -> str:
    delay, error = row.get("delay"), row.get("delay_error")
    if delay is None:
        return ""
    return f"{1e3 * delay:.2f}" + (f" ± {1e3 * error:.2f}" if error is not None else "")


def _estimate(row: Row) -> str:
    low, high = row.get("low"), row.get("high")
    half = f" ± {(high - low) / 2.0:.2g}" if low is not None and high is not None else ""
    return f"{row['parameter']} {row['estimate']:.4g}{half}"


def script_data(found: list[Entry]) -> str:
    """The rows as JSON that may stand in a script element: no text ends it."""
    data: dict[str, Any] = {
        "headers": HEADERS,
        "numeric": NUMERIC,
        "rows": [(e.state, e.cells, e.link, e.details) for e in found],
    }
    text = json.dumps(data, ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
