"""validate: whether each log fits the parameters of the others; and the page of a log."""

from __future__ import annotations

import json
import os
import shlex
from pathlib import Path

from steps import places
from steps.commands import Result, failure, of_each, run
from steps.journal import Journal
from steps.plan import Log, Plan, Robot
from steps.reference import others

OK: Result = {"status": 0}


def validate(plan: Plan, robot: Robot, group: str) -> None:
    """Validate the logs of a group that were identified."""
    identified = places.read(places.results(plan, robot, "identify", group))
    against = places.read(places.results(plan, robot, "reference"))
    motions = places.work(plan, robot, group, "motions")
    logs = plan.logs(robot, group)
    of_log = {log.name: result for log, result in zip(logs, identified, strict=True)}

    def step(log: Log) -> Result:
        before = of_log[log.name]
        places.cleared(plan, robot, log, "validate")
        if "estimates" not in before:
            return {"status": before["status"]}
        names = others(against, log)
        found = _validated(plan, robot, log, places.table(motions, log), names) if names else OK
        return found | _page(plan, robot, log, _needs_a_look(log, before, found, against), found)

    def resumed(log: Log) -> Result:
        own = places.folder_of(plan, robot, log)
        return journal.resumed(log, step, [own / name for name in places.MADE["validate"]], [])

    inputs = [
        places.results(plan, robot, "identify", group),
        places.results(plan, robot, "reference"),
    ]
    options = [*places.description(robot), robot.pipe["validate"], plan.pages]
    journal = Journal(places.work(plan, robot, group, "validate"), [*inputs, *options])
    found = of_each(resumed, logs)
    places.write(places.results(plan, robot, "validate", group), found)
    journal.close()


def _validated(plan: Plan, robot: Robot, log: Log, motion: Path, names: list[str]) -> Result:
    messages: list[str] = []
    own = places.folder_of(plan, robot, log)
    words = ["validate", str(motion)]
    for name in names:
        other = next(other for other in robot.logs if other.name == name)
        words += ["--parameters", str(places.folder_of(plan, robot, other) / "parameters.parquet")]
    words += ["--robot", robot.description, *shlex.split(robot.pipe["validate"])]
    if plan.pages != "none":
        words += ["--predictions", str(own / "prediction.parquet")]
    ran = run([*words, "-o", str(own / "metrics.parquet")], messages)
    found: Result = {"status": 0, "reference": names[0], "messages": messages}
    if ran.status:
        return found | failure(ran)
    table = places.columns(own / "metrics.parquet")
    change = json.loads(table.schema.metadata[b"scarid"])["extra"].get("change", {})
    found |= {"change": change.get("verdict"), "change_reason": change.get("reason")}
    return found | {"r2_validated": table.column("r2").to_pylist()}


def _needs_a_look(log: Log, before: Result, found: Result, against: Result) -> bool:
    compared = against.get("compared", {}).get(log.name, {})
    changed = found.get("change") not in ("unchanged", None) or compared.get("differs")
    return bool(changed or before["verdict"] != "good" or found.get("status"))


def _page(plan: Plan, robot: Robot, log: Log, needed: bool, found: Result) -> Result:  # noqa: FBT001
    """The log's own page, if there is to be one."""
    own = places.folder_of(plan, robot, log)
    prediction = own / "prediction.parquet"
    if plan.pages == "none" or (plan.pages == "needed" and not needed):
        prediction.unlink(missing_ok=True)
        return {}
    tables = [own / "parameters.parquet", own / "metrics.parquet", prediction]
    words = ["report", *(str(path) for path in tables if path.exists()), "-q", "-o", os.devnull]
    words += ["--html", str(own / "report.html"), "--title", f"{robot.name}: {log.name}"]
    messages: list[str] = []
    ran = run(words, messages)
    if ran.status:
        return {"messages": [*found.get("messages", []), *messages]}
    return {"page": str((own / "report.html").relative_to(plan.out))}
