"""From the logs of a group to parameters, with the motions beside them."""

from __future__ import annotations

import json
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path

from steps import places
from steps.commands import Result, failure, of_each, run
from steps.journal import Journal
from steps.plan import Log, Plan, Robot
from steps.prepare import prepare

from scarid_cli.errors import REQUIRED

ROWS = ("parameter", "unit", "estimate", "robust_error", "low", "high")
FACTS = ("verdict", "samples", "condition_number", "delay", "delay_error")


def identify(plan: Plan, robot: Robot, group: str) -> None:
    """Convert, check, resample, differentiate and identify the logs of a group."""
    tuned = places.read(places.results(plan, robot, "tune"))
    measurements, motions = (places.work(plan, robot, group, what) for what in ("logs", "motions"))
    for folder in (measurements, motions):
        folder.mkdir(parents=True, exist_ok=True)

    def step(log: Log) -> Result:
        own = places.cleared(plan, robot, log, "identify")
        measurement = places.table(measurements, log)
        found = prepare(robot, log, measurement, own / "check.json")
        if not found["status"] and tuned["status"]:
            found |= {key: tuned[key] for key in ("status", "step", "error")}
        if not found["status"]:
            found |= _identified(plan, robot, log, measurement, places.table(motions, log), found)
        measurement.unlink(missing_ok=True)
        return found

    def resumed(log: Log) -> Result:
        own = places.folder_of(plan, robot, log)
        made = [own / name for name in places.MADE["identify"]]
        return journal.resumed(log, step, made, [places.table(motions, log)])

    journal = Journal(places.work(plan, robot, group, "identify"), _inputs(plan, robot))
    found = of_each(resumed, plan.logs(robot, group))
    shutil.rmtree(measurements)
    places.write(places.results(plan, robot, "identify", group), found)
    journal.close()


def _inputs(plan: Plan, robot: Robot) -> Iterator[str | Path]:
    """What the results depend on beside the logs."""
    yield from places.description(robot)
    yield from (robot.pipe[name] for name in ("convert", "resample", "differentiate", "identify"))
    yield places.results(plan, robot, "tune")


def _identified(
    plan: Plan, robot: Robot, log: Log, measurement: Path, motion: Path, found: Result
) -> Result:
    parameters = places.folder_of(plan, robot, log) / "parameters.parquet"
    settings = ["--settings", str(plan.out / "robots" / robot.name / "settings.toml")]
    chosen = settings if robot.tuned else shlex.split(robot.pipe["differentiate"])
    words = ["differentiate", str(measurement), *chosen, "then", "tee", str(motion), "then"]
    words += ["identify", "--robot", robot.description, *shlex.split(robot.pipe["identify"])]
    ran = run([*words, "-o", str(parameters)], found["messages"])
    failed = failure(ran) if ran.status else {}
    return failed | (_facts(parameters) if ran.status in (0, REQUIRED) else {})


def _facts(parameters: Path) -> Result:
    """What the tables of the fleet say of an identification."""
    table = places.columns(parameters)
    extra = json.loads(table.schema.metadata[b"scarid"])["extra"]
    found = {key: extra.get(key) for key in FACTS}
    found["reasons"] = "; ".join(extra.get("reasons", []))
    found["r2"] = [joint["r2"] for joint in extra["joints"]]
    kept = [name for name in ROWS if name in table.column_names]
    found["estimates"] = table.select(kept).to_pylist()
    return found
