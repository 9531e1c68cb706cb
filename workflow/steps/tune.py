"""tune: one bandwidth for a robot, from the first log that passes the check."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path

from steps import places
from steps.commands import Result, failure, run
from steps.plan import TRIED, Log, Plan, Robot
from steps.prepare import prepare

from scarid_cli.errors import BAD_DATA, OK

RANKS = {"ok": 0, "warning": 1, "failed": 2}


def tune(plan: Plan, robot: Robot) -> None:
    """Tune on the first log that passes the check, else on the one that comes nearest to it."""
    settings = plan.out / "robots" / robot.name / "settings.toml"
    settings.parent.mkdir(parents=True, exist_ok=True)
    places.swept(settings.parent)
    for place in (settings, _trials(settings)):
        place.unlink(missing_ok=True)
    found: Result = {"status": OK, "tuned_on": None, "cutoff": None, "messages": []}
    if robot.tuned:
        folder = places.work(plan, robot, "tune", "logs")
        folder.mkdir(parents=True, exist_ok=True)
        found = _first(_candidates(robot, folder), robot, settings)
        shutil.rmtree(folder)
    places.write(places.results(plan, robot, "tune"), found)


def _first(candidates: Iterable[tuple[Log, Path]], robot: Robot, settings: Path) -> Result:
    """The result of tuning on the first log with which it succeeds."""
    none = "none of the first logs can be converted and checked: there is nothing to tune on"
    found: Result = {"status": BAD_DATA, "step": "tune", "error": none, "messages": []}
    for log, measurement in candidates:
        found = _tuned(robot, log, measurement, settings)
        if not found["status"]:
            break
    return found


def _candidates(robot: Robot, folder: Path) -> Iterator[tuple[Log, Path]]:
    """The first logs, those that pass the check before the others."""
    others = []
    for log in robot.logs[:TRIED]:
        measurement = places.table(folder, log)
        found = prepare(robot, log, measurement, folder / "check.json")
        if found["status"]:
            continue
        if RANKS[found["check"]]:
            others.append((RANKS[found["check"]], log.order, log, measurement))
        else:
            yield log, measurement
    for _, _, log, measurement in sorted(others, key=lambda entry: entry[:2]):
        yield log, measurement


def _tuned(robot: Robot, log: Log, measurement: Path, settings: Path) -> Result:
    messages: list[str] = []
    trials = _trials(settings)
    words = ["tune", str(measurement), "--robot", robot.description]
    words += [*shlex.split(robot.pipe["tune"]), "--save", str(settings), "-o", str(trials)]
    ran = run(words, messages)
    if ran.status:
        return {**failure(ran), "messages": messages}
    found = {"status": OK, "tuned_on": log.name, "cutoff": _cutoff(trials), "messages": messages}
    trials.unlink()
    return found


def _trials(settings: Path) -> Path:
    return settings.with_name("trials.parquet")


def _cutoff(trials: Path) -> float | None:
    """The chosen cut-off [Hz], if the trials judge one by scatter."""
    for row in places.columns(trials).to_pylist():
        if row["best"] and row["settings"].startswith("cutoff="):
            return float(row["settings"].split()[0].partition("=")[2])
    return None
