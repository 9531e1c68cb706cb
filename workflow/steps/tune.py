"""tune: one bandwidth for a robot, from the first log that passes the check."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
from steps import places
from steps.commands import Result, failure, run
from steps.plan import Log, Plan, Robot

from scarid_cli.errors import OK

RANKS = {"ok": 0, "warning": 1, "failed": 2}
TRIED = 5  # logs


def tune(plan: Plan, robot: Robot) -> None:
    """Tune on one log; if that fails, on the next one."""
    place = places.results(plan, robot, "tune")
    settings = plan.out / "robots" / robot.name / "settings.toml"
    settings.parent.mkdir(parents=True, exist_ok=True)
    settings.unlink(missing_ok=True)
    found: Result = {"status": OK, "tuned_on": None, "cutoff": None, "messages": []}
    if robot.tuned:
        none = "no log can be converted and checked"
        found = {"status": 65, "step": "tune", "error": f"{none}: there is nothing to tune on"}
        for log, measurement in list(_candidates(plan, robot))[:TRIED]:
            found = _tuned(robot, log, measurement, settings)
            if not found["status"]:
                break
    places.write(place, found)


def _candidates(plan: Plan, robot: Robot) -> Iterator[tuple[Log, Path]]:
    """The logs that were prepared, those that passed the check first."""
    ranked = []
    for group in plan.groups(robot):
        found = places.read(places.results(plan, robot, "prepare", group))
        folder = places.work(plan, robot, group, "logs")
        ranked += [
            (RANKS[result["check"]], log.order, log, places.table(folder, log))
            for log, result in zip(plan.logs(robot, group), found, strict=True)
            if not result["status"]
        ]
    for _, _, log, measurement in sorted(ranked, key=lambda entry: entry[:2]):
        yield log, measurement


def _tuned(robot: Robot, log: Log, measurement: Path, settings: Path) -> Result:
    messages: list[str] = []
    trials = settings.with_name("trials.parquet")
    words = ["tune", str(measurement), "--robot", robot.description]
    words += [*shlex.split(robot.pipe["tune"]), "--save", str(settings), "-o", str(trials)]
    ran = run(words, messages)
    if ran.status:
        return {**failure(ran), "messages": messages}
    found = {"status": OK, "tuned_on": log.name, "cutoff": _cutoff(trials), "messages": messages}
    trials.unlink()
    return found


def _cutoff(trials: Path) -> float | None:
    """The chosen cut-off [Hz], if the trials judge one by scatter."""
    for row in pq.read_table(trials).to_pylist():
        if row["best"] and row["settings"].startswith("cutoff="):
            return float(row["settings"].split()[0].partition("=")[2])
    return None
