"""differentiate and identify: from a measurement to parameters, with the motion beside them."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

import pyarrow.parquet as pq
from steps import places
from steps.commands import Result, failure, of_each, run
from steps.plan import Log, Plan, Robot

from scarid_cli.errors import REQUIRED

ROWS = ("parameter", "unit", "estimate", "robust_error", "low", "high")
FACTS = ("verdict", "samples", "condition_number", "delay", "delay_error")


def identify(plan: Plan, robot: Robot, group: str) -> None:
    """Identify the logs of a group that were prepared."""
    prepared = places.read(places.results(plan, robot, "prepare", group))
    tuned = places.read(places.results(plan, robot, "tune"))
    motions = places.work(plan, robot, group, "motions")
    motions.mkdir(parents=True, exist_ok=True)

    def step(entry: tuple[Log, Result]) -> Result:
        log, before = entry
        places.cleared(plan, robot, log, "identify")
        if before["status"]:
            return {"status": before["status"]}
        if tuned["status"]:
            return {key: tuned[key] for key in ("status", "step", "error")}
        return _identified(plan, robot, group, log, motions)

    entries = list(zip(plan.logs(robot, group), prepared, strict=True))
    places.write(places.results(plan, robot, "identify", group), of_each(step, entries))


def _identified(plan: Plan, robot: Robot, group: str, log: Log, motions: Path) -> Result:
    messages: list[str] = []
    parameters = places.folder_of(plan, robot, log) / "parameters.parquet"
    measurement = places.table(places.work(plan, robot, group, "logs"), log)
    settings = ["--settings", str(plan.out / "robots" / robot.name / "settings.toml")]
    chosen = settings if robot.tuned else shlex.split(robot.pipe["differentiate"])
    words = ["differentiate", str(measurement), *chosen, "then"]
    words += ["tee", str(places.table(motions, log)), "then"]
    words += ["identify", "--robot", robot.description, *shlex.split(robot.pipe["identify"])]
    ran = run([*words, "-o", str(parameters)], messages)
    if ran.status not in (0, REQUIRED):
        return {**failure(ran), "messages": messages}
    found = failure(ran) if ran.status else {"status": 0}
    return {**found, "messages": messages, **_facts(parameters)}


def _facts(parameters: Path) -> Result:
    """What the tables of the fleet say of an identification."""
    table = pq.read_table(parameters)
    extra = json.loads(table.schema.metadata[b"scarid"])["extra"]
    found = {key: extra.get(key) for key in FACTS}
    found["reasons"] = "; ".join(extra.get("reasons", []))
    found["r2"] = [joint["r2"] for joint in extra["joints"]]
    kept = [name for name in ROWS if name in table.column_names]
    found["estimates"] = table.select(kept).to_pylist()
    return found
