"""Made-up tables of a batch, for the tests of the page of a fleet and for its benchmark."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from scarid_cli.io import schemas
from scarid_cli.io.table import METADATA_KEY, Metadata


def date(order: int) -> str:
    """The day of a log, one after the other."""
    return str(np.datetime64("2025-12-31") + order)


def done(robot: str, order: int, **other: Any) -> dict[str, Any]:
    """A log in which nothing was found, but for `other` columns."""
    day = date(order)
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
        "reference": date(1),
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
        "log": date(order),
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
    return {**row, "reference": date(1), "trend": "no trend over the 3 tables", **other}


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
