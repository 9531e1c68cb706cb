"""The logs of a robot that stand for the others, and how the others differ from the first."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
from steps import places
from steps.commands import Result, run
from steps.plan import Log, Plan, Robot

from scarid_cli.arrays import Array
from scarid_cli.printable import utf8

VERDICTS = {"good": 0, "rough": 1, "doubtful": 2, "not identifiable": 3}
POOLED = 4  # logs against which another one is validated, at most
SETTLED = 3  # the rank from which a log does not count for the trend
NEIGHBOURS = 3  # logs before and after one
FAR = 6.0  # usual distances
MAD = 1.4826  # standard deviations of a normal distribution per median absolute deviation

Entry = tuple[Log, Result]


def reference(plan: Plan, robot: Robot) -> None:
    """Choose the logs that stand for all, compare all others with the first, look for a trend."""
    identified = _identified(plan, robot)
    nearest = _nearest(identified)
    messages: list[str] = []
    found: Result = {"reference": None, "nearest": [], "messages": messages}
    if len(nearest) > 1:
        found |= {"reference": nearest[0].name, "nearest": [log.name for log in nearest]}
        found |= _compared(plan, robot, nearest[0], [log for log, _ in identified], messages)
        found |= _trend(plan, robot, identified, messages)
    places.write(places.results(plan, robot, "reference"), found)


def _identified(plan: Plan, robot: Robot) -> list[Entry]:
    """The logs with parameters, and what was found of each."""
    return [
        (log, result)
        for group in plan.groups(robot)
        for log, result in zip(
            plan.logs(robot, group),
            places.read(places.results(plan, robot, "identify", group)),
            strict=True,
        )
        if "estimates" in result
    ]


def _alike(identified: list[Entry]) -> tuple[list[Entry], Array, Array]:
    """The logs with the parameters of the first one, their values, and their errors."""
    names = [[row["parameter"] for row in result["estimates"]] for _, result in identified]
    alike = [entry for entry, own in zip(identified, names, strict=True) if own == names[0]]
    rows = [[(row["estimate"], row.get("robust_error") or 0.0) for row in result["estimates"]]
            for _, result in alike]  # fmt: skip
    values = np.array(rows, dtype=float).reshape(len(alike), -1, 2)
    return alike, values[..., 0], values[..., 1]


def _spread(apart: Array, errors: Array) -> Array:
    """How far values usually are apart: by their scatter, or by their errors if these are larger.

    Neither outliers nor parameters that never change make it zero.
    """
    scatter = MAD * np.median(np.abs(apart), axis=0)
    least = np.finfo(float).tiny
    return np.maximum(np.maximum(scatter, np.median(errors, axis=0)), least)


def _rank(result: Result) -> int:
    """How little an identification is worth, by its verdict and by the check of its log."""
    return SETTLED if result["check"] == "failed" else VERDICTS[result["verdict"]]


def _nearest(identified: list[Entry]) -> list[Log]:
    """The logs nearest to the median of all parameters, of those with the best verdict, in order.

    They are at most half of these, so that a minority of changed logs stays out, and one more,
    which takes the place of each of them where it is validated itself; two at least.
    """
    if not identified:
        return []
    alike, values, errors = _alike(identified)
    apart = values - np.median(values, axis=0)
    distances = np.sqrt(np.mean((apart / _spread(apart, errors)) ** 2, axis=1))
    ranks = [_rank(result) for _, result in alike]
    ordered = sorted(zip(ranks, distances.tolist(), range(len(alike)), strict=True))
    among = ranks.count(min(ranks)) // 2
    return [alike[i][0] for _, _, i in ordered[: max(1, min(POOLED, among)) + 1]]


def others(against: Result, log: Log) -> list[str]:
    """The names of the logs against which one is validated: the nearest ones without itself."""
    names = [name for name in against["nearest"] if name != log.name]
    return names[: len(against["nearest"]) - 1]


def _steady(identified: list[Entry]) -> list[Log]:
    """The logs for a trend: without those that are far from the logs just before and after them."""
    alike, values, errors = _alike(identified)
    sides = []
    for order in (1, -1):
        ordered = values[::order]
        near = [
            np.median(ordered[max(i - NEIGHBOURS, 0) : i], axis=0) for i in range(1, len(alike))
        ]
        sides.append(np.vstack([np.full_like(values[:1], np.nan), *near])[::order])
    before, after = values - sides[0], values - sides[1]
    apart = np.fmin(np.abs(before), np.abs(after))
    apart[before * after <= 0.0] = 0.0  # between its neighbours, as where something drifts
    usual = np.nanmedian(np.abs(before), axis=0)
    scale = np.maximum(np.maximum(usual, np.median(errors, axis=0)), np.finfo(float).tiny)
    far = np.any(apart > FAR * scale, axis=1)
    return [log for (log, _), out in zip(alike, far, strict=True) if not out]


def _compared(plan: Plan, robot: Robot, first: Log, logs: list[Log], messages: list[str]) -> Result:
    """The comparison of every log with the reference, by the name of the log."""
    place = plan.out / "robots" / robot.name / "compare.parquet"
    places.swept(place.parent)
    paths = {str(_parameters(plan, robot, log)): log.name for log in logs if log != first}
    ran = run(["compare", str(_parameters(plan, robot, first)), *paths, "-o", str(place)], messages)
    del messages[1:]  # thousands of lines, which the table has as well
    if ran.status:
        messages.append(ran.error)
        return {"compared": {}}
    table = places.columns(place)
    facts = json.loads(table.schema.metadata[b"scarid"])["extra"]["comparisons"]
    compared: dict[str, Result] = {
        paths[fact["table"]]: {
            "differs": fact["differ"],
            "p_value": fact["joint"] and fact["joint"]["p_value"],
            "parameters": {},
        }
        for fact in facts
    }
    written = {utf8(path): name for path, name in paths.items()}
    for row in table.to_pylist():
        entry = compared[written[row["table"]]]
        entry["parameters"][row["parameter"]] = [row["errors"], row["p_value"]]
    return {"compared": compared}


def _trend(plan: Plan, robot: Robot, identified: list[Entry], messages: list[str]) -> Result:
    """The trend over the logs in order, which `compare` finds in three and more tables."""
    judged = [entry for entry in identified if _rank(entry[1]) < SETTLED]
    logs = _steady(judged) if len(judged) > 2 else []
    if len(logs) < 3:
        return {}
    paths = [str(_parameters(plan, robot, log)) for log in logs]
    ran = run(["compare", *paths, "-o", os.devnull], [])
    sentences = [line.partition(": ")[2] for line in ran.said if "trend" in line]
    if ran.status or not sentences:
        messages.append(ran.error)
        return {}
    return {"trend": sentences[-1]}


def _parameters(plan: Plan, robot: Robot, log: Log) -> Path:
    return places.folder_of(plan, robot, log) / "parameters.parquet"
