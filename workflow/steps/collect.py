"""The tables of a batch: a row for each log, for each parameter of each log, and for each robot."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
from steps import places
from steps.commands import Result
from steps.plan import Log, Plan, Robot

from scarid_cli.io import schemas
from scarid_cli.io.table import Metadata, Table, table_of
from scarid_cli.io.writer import Output, all_or_none
from scarid_cli.printable import utf8

STEPS = ("identify", "validate")
LEVEL = 0.05  # of `compare`
Row = dict[str, Any]


def collect(plan: Plan) -> None:
    """Write the tables, and the messages of each log."""
    places.swept(plan.out)
    logs: list[Row] = []
    estimates: list[Row] = []
    robots: list[Row] = []
    for robot in plan.robots:
        tuned, against = (
            places.read(places.results(plan, robot, step)) for step in ("tune", "reference")
        )
        own = []
        for log, steps in _results(plan, robot):
            merged = _merged(steps)
            own.append(_row(robot, log, merged, against))
            estimates += _estimates(robot, log, merged, against)
            _say(plan, robot, log, steps)
        logs += own
        robots.append(_robot(robot, own, tuned, against))
    joints = max((len(row["r2"] or ()) for row in logs), default=0)
    outputs = [
        (_table("fleet", logs, joints), plan.out / "fleet.parquet"),
        (_table("estimates", estimates, 0), plan.out / "estimates.parquet"),
        (_table("robots", robots, 0), plan.out / "robots.parquet"),
    ]
    for table, path in outputs:
        _write(table, path)
    _write_text(_table("fleet", logs, joints), plan.out / "fleet.tsv")


def _results(plan: Plan, robot: Robot) -> Iterator[tuple[Log, list[Result]]]:
    """Each log of a robot, with what each step found."""
    for group in plan.groups(robot):
        steps = [places.read(places.results(plan, robot, step, group)) for step in STEPS]
        yield from zip(plan.logs(robot, group), map(list, zip(*steps, strict=True)), strict=True)


def _merged(steps: list[Result]) -> Result:
    """What all steps found; the first failure is the one that counts."""
    merged: Result = {}
    for found in steps:
        merged |= {key: value for key, value in found.items() if key not in merged}
        if not merged["status"]:
            del merged["status"]
    return {"status": 0, **merged}


def _row(robot: Robot, log: Log, merged: Result, against: Result) -> Row:
    compared = against.get("compared", {}).get(log.name)
    row = {**vars(log), **merged, "robot": robot.name, "log": log.name, "r2": merged.get("r2")}
    if compared:
        p = {
            name: value for name, (_, value) in compared["parameters"].items() if value is not None
        }
        differing = sorted((name for name in p if p[name] < LEVEL), key=lambda name: p[name])
        row["compare"] = "differs" if compared["differs"] else "agrees"
        row["differing"] = ", ".join(differing) or None
        row["p_value"] = compared["p_value"]
    return row


def _estimates(robot: Robot, log: Log, merged: Result, against: Result) -> Iterator[Row]:
    compared = against.get("compared", {}).get(log.name, {}).get("parameters", {})
    for row in merged.get("estimates", ()):
        errors, p_value = compared.get(row["parameter"], (None, None))
        known = {"robot": robot.name, "log": log.name, "order": log.order, "date": log.date}
        yield {**known, **row, "errors": errors, "p_value": p_value}


def _robot(robot: Robot, rows: list[Row], tuned: Result, against: Result) -> Row:
    trend = against.get("trend", "")
    _, _, listed = trend.partition("per table: ")
    return {
        "robot": robot.name,
        "description": robot.description,
        "logs": len(rows),
        "identified": sum("estimates" in row for row in rows),
        "failed": sum(row["status"] != 0 for row in rows),
        "reference": against["reference"],
        "pooled": ", ".join(against["nearest"][:-1]) or None,
        "cutoff": tuned.get("cutoff"),
        "tuned_on": tuned.get("tuned_on"),
        "trend": trend or None,
        "trending": ", ".join(part.split()[0] for part in listed.split(", ") if part) or None,
    }


def _table(kind: str, rows: list[Row], joints: int) -> Table:
    """The table of a kind; columns of joints come from the lists of the same name."""
    schema = schemas.load(kind)
    fields, columns = [], []
    for field in schema.fields:
        metadata = {"unit": field.units[0]} if field.units else None
        if not field.per_joint:
            fields.append(pa.field(field.name, field.type, metadata=metadata))
            columns.append([row.get(field.name) for row in rows])
            continue
        stem = field.name.removesuffix("_{i}")
        for i in range(joints):
            fields.append(pa.field(f"{stem}_{i + 1}", field.type))
            columns.append([_at(row.get(stem), i) for row in rows])
    meta = Metadata(kind=kind, version=schema.version)
    if not rows:
        return Table(kind, pa.schema(fields), meta, iter(()))
    return table_of(kind, pa.schema(fields), zip(*columns, strict=True), meta)


def _at(values: list[Any] | None, index: int) -> Any:
    return values[index] if values and index < len(values) else None


def _write(table: Table, path: Path) -> None:
    output = Output(str(path))
    with all_or_none([output]):
        output.take(table)


def _write_text(table: Table, path: Path) -> None:
    """The same as text separated by tabs, for other tools."""
    rows: Iterable[Row] = (row for batch in table.batches for row in batch.to_pylist())
    part = path.with_suffix(".part")
    with part.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, delimiter="\t", lineterminator="\n")
        writer.writerow(table.columns)
        writer.writerows(row.values() for row in rows)
    part.replace(path)


def _say(plan: Plan, robot: Robot, log: Log, steps: list[Result]) -> None:
    """Write what the commands were and what they said of a log."""
    lines = [line for found in steps for line in found.get("messages", ())]
    folder = places.folder_of(plan, robot, log)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "messages.txt").write_text(utf8("\n".join([*lines, ""])), "utf-8")
