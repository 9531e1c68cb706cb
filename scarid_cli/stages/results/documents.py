"""Results as documents for machines, by the schemas in `schemas/documents/`.

Numbers are numbers; what is not known, or not finite, is null. Units are named beside the numbers,
or in the schema. A `half_interval` is half the 95 % interval: what stands behind +- elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, nan
from typing import Any

import numpy as np

from scarid_cli import __version__
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.io.table import Table
from scarid_cli.stages.models.controllers import settings
from scarid_cli.stages.results.parameters import EVIDENCE

Row = dict[str, Any]
Document = dict[str, Any]


def identification(table: Table, estimator: str) -> Document:
    """What `identify` has found, from its table of parameters."""
    rows, extra = _rows(table), table.meta.extra
    return _document(
        {
            **_head("identify", table),
            "estimator": estimator,
            "verdict": extra["verdict"],
            "biased": extra["biased"],
            "reasons": list(extra["reasons"]),
            "samples": extra.get("samples"),
            "condition_number": extra.get("condition_number"),
            "bandwidth": extra.get("bandwidth"),
            "delay": _delay(extra),
            "friction": extra.get("friction"),
            "parameters": [_with_half(row) for row in rows],
            "joints": [
                {
                    "joint": number,
                    **{name: joint.get(key) for name, key in OF_A_JOINT.items()},
                    **{
                        name: half_interval(joint.get(key), extra)
                        for name, key in INTERVALS.items()
                    },
                }
                for number, joint in enumerate(extra.get("joints", ()), start=1)
            ],
        }
    )


# The figures of a joint: their names here, and in the metadata of the table.
OF_A_JOINT = {
    "r2": "r2",
    "relative_error": "relative_error",
    "needed_half_interval": "needed",
}
# Those with standard errors in the metadata.
INTERVALS = {"torque_half_interval": "torque_error", "inertia_half_interval": "inertia_error"}


def half_interval(error: float | None, extra: dict[str, Any]) -> float | None:
    """Half the 95 % interval, of a standard error in the metadata."""
    blocks = (extra.get(EVIDENCE) or {}).get("blocks")
    return None if error is None or not blocks else quantile(0.975, blocks - 1.0) * error


def validation(table: Table) -> Document:
    """What `validate` has found, from its table of metrics."""
    change = table.meta.extra.get("change") or {}
    return _document(
        {
            **_head("validate", table),
            "verdict": change.get("verdict"),
            "reason": change.get("reason"),
            "p_value": change.get("p_value"),
            "tests": change.get("tests"),
            "explained": change.get("explained"),
            "explanations": change.get("explanations", []),
            "wiring": change.get("wiring", []),
            "joints": _rows(table),
            "contacts": table.meta.extra.get("contact"),
            "rollout": table.meta.extra.get("rollout"),
        }
    )


def of_gains(table: Table) -> Document:
    """What `gains` has found, from its table."""
    rows = _rows(table)
    told = [row["joint"] for row in rows if row["gain"] is not None]
    return _document(
        {
            **_head("gains", table),
            "told": told,
            "wrong": table.meta.extra["wrong"],
            "loaded": table.meta.extra["loaded"],
            "joints": rows,
        }
    )


def of_payload(table: Table) -> Document:
    """What `payload` has found, from its table."""
    rows, extra = _rows(table), table.meta.extra
    told = [row["quantity"] for row in rows if row["robust_error"] is not None]
    body, lows = (
        np.array([nan if row[name] is None else row[name] for row in rows])
        for name in ("body", "low")
    )
    return _document(
        {
            **_head("payload", table),
            **{name: extra[name] for name in ("frame", "possible", "away", "loaded")},
            "told": told,
            "values": [_with_half(row) for row in rows],
            "controllers": settings(body, lows),
        }
    )


def comparison(table: Table) -> Document:
    """What `compare` has found, from its table of differences."""
    extra = table.meta.extra
    pairs = extra["comparisons"]
    return _document(
        {
            **_head("compare", table),
            "verdict": worst(pairs),
            "level": extra["level"],
            "comparisons": pairs,
            "trend": extra.get("trend"),
            "parameters": _rows(table),
        }
    )


def worst(pairs: Sequence[Row]) -> str:
    """The verdict on all pairs: differ if one differs."""
    return str(next((pair for pair in pairs if pair["differ"]), pairs[0])["verdict"])


def _head(command: str, table: Table) -> Document:
    return {"command": command, "version": __version__, "robot": table.meta.robot}


def _delay(extra: Row) -> Document | None:
    """By what time the torques lead the motion [s]; null if it was not fitted."""
    if extra.get("delay") is None:
        return None
    return {"seconds": extra["delay"], "standard_error": extra.get("delay_error")}


def _with_half(row: Row) -> Row:
    """A row of a table, with half its 95 % interval."""
    low, high = row.get("low"), row.get("high")
    half = 0.5 * (high - low) if low is not None and high is not None else None
    return {**row, "half_interval": half}


def _rows(table: Table) -> list[Row]:
    return [row for batch in table.batches for row in batch.to_pylist()]


def _document(facts: Document) -> Document:
    return {key: _known(value) for key, value in facts.items()}


def _known(value: Any) -> Any:
    """The value, with null for each number that is not finite."""
    if isinstance(value, dict):
        return {key: _known(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_known(item) for item in value]
    return None if isinstance(value, float) and not isfinite(value) else value
