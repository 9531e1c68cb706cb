"""Small outcomes of a batch, for the tests of the fleet page."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from scarid_cli.io import schemas
from scarid_cli.io.table import METADATA_KEY, Metadata


def done(robot: str, order: int, **other: Any) -> dict[str, Any]:
    """A log in which nothing was found, but for `other` columns."""
    day = f"2026-01-{order:02d}"
    return {
        "robot": robot,
        "log": day,
        "file": f"logs/{robot}/{day}.csv",
        "date": day,
        "order": order,
        "status": 0,
        "check": "ok",
        "verdict": "good",
        "delay": 5e-4,
        "delay_error": 1e-4,
        "r2_1": 0.9991,
        "r2_2": 0.9982,
        "reference": "2026-01-01",
        "r2_validated_1": 0.9981,
        "r2_validated_2": 0.9972,
        "change": "unchanged",
        "compare": "agrees",
        **other,
    }


def failed(robot: str, order: int, error: str) -> dict[str, Any]:
    """A log that could not be converted."""
    kept = {key: done(robot, order)[key] for key in ("robot", "log", "file", "date", "order")}
    return {**kept, "status": 65, "step": "convert", "error": error}


def estimate(robot: str, order: int, parameter: str, value: float, **other: Any) -> dict[str, Any]:
    """A parameter that is known to 1 % of 1."""
    return {
        "robot": robot,
        "log": f"2026-01-{order:02d}",
        "order": order,
        "parameter": parameter,
        "unit": "N m",
        "estimate": value,
        "robust_error": 0.01,
        "low": value - 0.02,
        "high": value + 0.02,
        "errors": (value - 1.0) / 0.014,
        **other,
    }


def robot(name: str, **other: Any) -> dict[str, Any]:
    row = {"robot": name, "description": "x.toml", "logs": 3, "identified": 3, "failed": 0}
    return {**row, "reference": "2026-01-01", "trend": "no trend over the 3 tables", **other}


def write(folder: Path, **rows: list[dict[str, Any]]) -> Path:
    """The tables of a batch: `fleet`, `estimates` and `robots`."""
    folder.mkdir(exist_ok=True)
    for kind, found in rows.items():
        fields = [f for f in schemas.load(kind).fields if not f.per_joint]
        names = {f.name: f.type for f in fields}
        names |= {key: pa.float64() for row in found for key in row if key.startswith("r2_")}
        columns = {name: pa.array([row.get(name) for row in found], t) for name, t in names.items()}
        meta = {METADATA_KEY: Metadata(kind=kind).to_json()}
        table = pa.table(columns).replace_schema_metadata(meta)
        pq.write_table(table, folder / f"{kind}.parquet")
    return folder


def small(folder: Path) -> Path:
    """Three robots: one is fine, one drifts, and one has a failed and a doubtful log."""
    logs = [done("steady", i) for i in (1, 2, 3)]
    drift = {"change": "changed", "compare": "differs", "differing": "Fs2, Fv1", "p_value": 1e-9}
    drift |= {"change_reason": "friction of joint 2", "page": "logs/drifting/3/report.html"}
    logs += [done("drifting", 1), done("drifting", 2), done("drifting", 3, **drift)]
    doubtful = {"verdict": "doubtful", "reasons": "too slow", "check": "warning"}
    doubtful |= {"findings": "clock: 3 gaps"}
    said = "scarid convert: logs/mixed/2026-01-03.csv, row 5: found 12 values"
    logs += [done("mixed", 1), done("mixed", 2, **doubtful), failed("mixed", 3, said)]
    estimates = [
        estimate(name, i, parameter, 1.0 + (name == "drifting") * 0.1 * i)
        for name in ("steady", "drifting")
        for i in (1, 2, 3)
        for parameter in ("Fs2", "Fv1")
    ]
    trend = "trend over the 3 tables, per table: Fs2 +0.1 N m (9 errors)"
    robots = [robot("steady"), robot("drifting", trend=trend, trending="Fs2"), robot("mixed")]
    return write(folder, fleet=logs, estimates=estimates, robots=robots)


def data(page: str) -> dict[str, Any]:
    """What the script of a page is given."""
    match = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    assert match
    found: dict[str, Any] = json.loads(match.group(1))
    return found
