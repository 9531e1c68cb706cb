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
import pyarrow as pa
import pyarrow.parquet as pq

from scarid_cli.io.table import METADATA_KEY, Metadata

Columns = dict[str, list[Any]]
UNITS = {"ZZ": "kg m2", "MX": "kg m", "Fv": "N m s/rad", "Fs": "N m"}


def write(folder: Path, kind: str, columns: Columns) -> None:
    """One table of a batch, as the workflow writes it."""
    meta = {METADATA_KEY: Metadata(kind=kind).to_json()}
    pq.write_table(pa.table(columns).replace_schema_metadata(meta), folder / f"{kind}.parquet")


def fleet(folder: Path, logs: int, robots: int, joints: int) -> None:
    """The three tables, from a fixed seed."""
    rng = np.random.default_rng(1)
    rows: dict[str, Columns] = {"fleet": {}, "estimates": {}, "robots": {}}
    for number in range(1, robots + 1):
        name, count = f"robot{number:02d}", logs // robots
        states = rng.choice(3, count, p=(0.94, 0.04, 0.02))  # done, failed, changed
        drifts = number == 2
        for order, state in enumerate(states, 1):
            add(rows["fleet"], log_row(rng, name, order, int(state), joints))
            if state != 1:
                for row in estimates(rng, name, order, int(state), joints, drift=drifts):
                    add(rows["estimates"], row)
        add(rows["robots"], robot_row(name, states, drift=drifts))
    for kind, columns in rows.items():
        write(folder, kind, columns)


def add(columns: Columns, row: dict[str, Any]) -> None:
    for name, value in row.items():
        columns.setdefault(name, []).append(value)


def log_row(
    rng: np.random.Generator, robot: str, order: int, state: int, joints: int
) -> dict[str, Any]:
    """A log that is done (0), failed (1) or changed (2)."""
    failed, changed = state == 1, state == 2
    day = str(np.datetime64("2024-01-01") + order)
    error = f"scarid convert: logs/{robot}/{day}.csv, row {order}: found 12 values, expected 11"
    reason = "another payload or set-up (ZZ2 +0.04 +- 0.00018 kg m2); this explains 100 %"
    r2 = {f"r2_{i}": None if failed else 1.0 - rng.gamma(2.0, 0.004) for i in range(1, joints + 1)}
    return {
        "robot": robot,
        "log": day,
        "file": f"logs/{robot}/{day}.csv",
        "date": day,
        "order": order,
        "status": 65 if failed else 0,
        "step": "convert" if failed else None,
        "error": error if failed else None,
        "check": None if failed else "ok",
        "verdict": None if failed else "good",
        "reasons": None if failed else "7 of 8 parameters known within 30 %, torque within 0.2 %",
        "samples": None if failed else 20000,
        "condition_number": None if failed else float(rng.normal(250.0, 30.0)),
        "delay": None if failed else float(rng.normal(5e-4, 5e-5)),
        "delay_error": None if failed else 8e-5,
        **r2,
        "reference": None if failed else "2024-01-02",
        "change": None if failed else ("changed" if changed else "unchanged"),
        "change_reason": reason if changed else None,
        "compare": None if failed else ("differs" if changed else "agrees"),
        "differing": "ZZ2" if changed else None,
        "p_value": None if failed else 1e-9 if changed else 0.5,
        "page": None if failed else f"logs/{robot}/{day}/report.html",
    }


def estimates(
    rng: np.random.Generator, robot: str, order: int, state: int, joints: int, *, drift: bool
) -> list[dict[str, Any]]:
    """Four parameters of each joint."""
    rows = []
    for joint in range(1, joints + 1):
        for name, unit in UNITS.items():
            value = 1.0 + 0.001 * order * (drift and name == "Fs")
            value += 0.2 * (state == 2 and name == "ZZ" and joint == 2)
            estimate, half = value + float(rng.normal(0.0, 0.01)), 0.02
            rows.append(
                {
                    "robot": robot,
                    "log": f"{order}",
                    "order": order,
                    "parameter": f"{name}{joint}",
                    "unit": unit,
                    "estimate": estimate,
                    "robust_error": 0.01,
                    "low": estimate - half,
                    "high": estimate + half,
                    "errors": (estimate - 1.0) / 0.014,
                }
            )
    return rows


def robot_row(name: str, states: np.ndarray, *, drift: bool) -> dict[str, Any]:
    count, failed = len(states), int((states == 1).sum())
    return {
        "robot": name,
        "description": f"{name}.toml",
        "logs": count,
        "identified": count - failed,
        "failed": failed,
        "reference": "2024-01-02",
        "trend": f"trend over the {count} tables, per table: Fs1 +0.001 N m (45 errors)"
        if drift
        else f"no trend over the {count} tables",
        "trending": "Fs1" if drift else None,
    }


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
