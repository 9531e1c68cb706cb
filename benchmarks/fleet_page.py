"""How long the page of a fleet takes and how large it is: logs of several robots, made up here.

    python benchmarks/fleet_page.py [LOGS [ROBOTS [JOINTS [FOLDER]]]]

Of the logs 4 % have failed and 2 % have changed, and the friction of one robot drifts. The tables
and the page stay in FOLDER, if it is given.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import outcomes

UNITS = {"ZZ": "kg m2", "MX": "kg m", "Fv": "N m s/rad", "Fs": "N m"}
DONE, FAILED, CHANGED = range(3)
Row = dict[str, Any]


def fleet(folder: Path, logs: int, robots: int, joints: int) -> None:
    """The three tables, from a fixed seed."""
    rng = np.random.default_rng(1)
    rows: dict[str, list[Row]] = {"fleet": [], "estimates": [], "robots": []}
    for number in range(1, robots + 1):
        name, drifts = f"robot{number:02d}", number == 2
        states = rng.choice((DONE, FAILED, CHANGED), logs // robots, p=(0.94, 0.04, 0.02))
        for order, state in enumerate(states, 1):
            rows["fleet"].append(log_row(rng, name, order, state, joints))
            if state != FAILED:
                rows["estimates"] += estimates(rng, name, order, state, joints, drift=drifts)
        rows["robots"].append(robot_row(name, states, drift=drifts))
    outcomes.write(folder, **rows)


def log_row(rng: np.random.Generator, robot: str, order: int, state: int, joints: int) -> Row:
    """A log that is done, has failed or has changed."""
    day = outcomes.date(order)
    if state == FAILED:
        error = f"scarid convert: logs/{robot}/{day}.csv, row {order}: found 12 values, expected 11"
        return outcomes.failed(robot, order, error)
    found = {
        "reasons": "7 of 8 parameters known within 30 %, torque within 0.2 %",
        "samples": 20000,
        "condition_number": rng.normal(250.0, 30.0),
        "delay": rng.normal(5e-4, 5e-5),
        "p_value": 0.5,
        "page": f"logs/{robot}/{day}/report.html",
        **{f"r2_{i}": 1.0 - rng.gamma(2.0, 0.004) for i in range(1, joints + 1)},
    }
    if state == CHANGED:
        reason = "another payload or set-up (ZZ2 +0.04 +- 0.00018 kg m2); this explains 100 %"
        found |= {"change": "changed", "change_reason": reason}
        found |= {"compare": "differs", "differing": "ZZ2", "p_value": 1e-9}
    return outcomes.done(robot, order, **found)


def estimates(
    rng: np.random.Generator, robot: str, order: int, state: int, joints: int, *, drift: bool
) -> list[Row]:
    """Four parameters of each joint."""
    rows = []
    for joint in range(1, joints + 1):
        for name, unit in UNITS.items():
            value = 1.0 + 0.001 * order * (drift and name == "Fs") + rng.normal(0.0, 0.01)
            value += 0.2 * (state == CHANGED and name == "ZZ" and joint == 2)
            rows.append(outcomes.estimate(robot, order, f"{name}{joint}", value, unit=unit))
    return rows


def robot_row(name: str, states: np.ndarray, *, drift: bool) -> Row:
    count, failed = len(states), int((states == FAILED).sum())
    trend = f"trend over the {count} tables, per table: Fs1 +0.001 N m (45 errors)"
    found = (
        {"trend": trend, "trending": "Fs1"}
        if drift
        else {"trend": f"no trend over the {count} tables"}
    )
    counts = {"logs": count, "identified": count - failed, "failed": failed}
    return outcomes.robot(name, description=f"{name}.toml", **counts, **found)


def run(folder: Path, logs: int, robots: int, joints: int) -> None:
    fleet(folder, logs, robots, joints)
    page = folder / "fleet.html"
    command = [sys.executable, "-m", "scarid_cli", "report", "--fleet", str(folder)]
    start = time.perf_counter()
    subprocess.run([*command, "--html", str(page)], check=True, stdout=subprocess.DEVNULL)
    seconds = time.perf_counter() - start
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu, memory = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0
    print(
        f"{logs} logs of {robots} robots, {4 * joints} parameters each: report takes "
        f"{seconds:.2f} s ({cpu:.2f} s of one core) and {memory:.0f} MB of memory, "
        f"the page has {page.stat().st_size / 1e6:.2f} MB"
    )


if __name__ == "__main__":
    logs, robots, joints = (int(x) for x in (*sys.argv[1:4], *(10000, 20, 2)[len(sys.argv[1:4]) :]))
    if len(sys.argv) > 4:
        Path(sys.argv[4]).mkdir(parents=True, exist_ok=True)
        run(Path(sys.argv[4]), logs, robots, joints)
    else:
        with tempfile.TemporaryDirectory() as place:
            run(Path(place), logs, robots, joints)
