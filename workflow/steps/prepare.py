"""convert, check, resample: from a log to a measurement at a constant rate."""

from __future__ import annotations

import json
import shlex
from pathlib import Path

from steps import places
from steps.commands import Result, failure, of_each, run
from steps.plan import Log, Plan, Robot


def prepare(plan: Plan, robot: Robot, group: str) -> None:
    """Convert, check and resample the logs of a group."""
    folder = places.work(plan, robot, group, "logs")
    folder.mkdir(parents=True, exist_ok=True)
    logs = plan.logs(robot, group)
    found = of_each(lambda log: _prepared(plan, robot, log, folder), logs)
    places.write(places.results(plan, robot, "prepare", group), found)


def _prepared(plan: Plan, robot: Robot, log: Log, folder: Path) -> Result:
    own = places.cleared(plan, robot, log, "prepare")
    measurement, messages = places.table(folder, log), list[str]()
    described = shlex.join(["--robot", robot.description])
    resample = robot.pipe["resample"]
    first = measurement.with_suffix(".converted.parquet") if resample else measurement
    convert = f"convert {described} {robot.pipe['convert']} {shlex.quote(log.file)}"
    ran = run(
        f"{convert} then tee {shlex.quote(str(first))} then check --json {described}", messages
    )
    if not ran.out:
        return {**failure(ran), "messages": messages}
    (own / "check.json").write_text(ran.out, "utf-8")
    found = {"status": 0, "messages": messages, **_findings(ran.out)}
    if resample:
        words = ["resample", str(first), *shlex.split(resample), "-o", str(measurement)]
        ran = run(words, messages)
        first.unlink()
        found |= failure(ran) if ran.status else {}
    return found


def _findings(document: str) -> Result:
    """The worst status, and the findings that are not ok."""
    found = json.loads(document)
    texts = [f"{c['name']}: {c['figure']}" for c in found["checks"] if c["status"] != "ok"]
    return {"check": found["status"], "findings": "; ".join(texts)}
