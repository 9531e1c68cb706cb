"""Are the expected errors of a planned experiment met? On the simulated SCARA, by whole pipes.

    python benchmarks/experiments.py --runs 200

Each experiment is the shell pipe that a user would type: `scarid trajgen`, `simulate`,
`differentiate` and `identify --estimator wls --drop-slow 0.1 --align`. The table compares the
errors that `trajgen --expected` predicts with the scatter of the estimates over simulated logs.
"""

from __future__ import annotations

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

ROBOT = load("scara2")
IDENTIFY = "scarid differentiate | scarid identify -q --estimator wls --drop-slow 0.1 --align"


def shell(folder: Path, line: str) -> str:
    """What a shell line prints, with the commands of this installation first."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        ["bash", "-euo", "pipefail", "-c", line],
        cwd=folder,
        env={**os.environ, "PATH": path},
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    ).stdout


def column(table: str, name: str) -> Array:
    """A column of the parameters of the robot."""
    rows = [row for row in csv.DictReader(table.splitlines()) if row["parameter"] in ROBOT.names]
    return np.array([float(row[name] or "nan") for row in rows])


def expected(folder: Path, runs: int) -> None:
    """The expected error of each parameter and the scatter of its estimates over the runs."""
    plan = "scarid trajgen -q --seed 1 --expected errors.csv -o reference.parquet; cat errors.csv"
    errors = column(shell(folder, plan), "expected_error")

    def estimates(seed: int) -> Array:
        line = f"scarid simulate --seed {seed} --format arrow reference.parquet | {IDENTIFY}"
        return column(shell(folder, line), "estimate")

    with ThreadPoolExecutor(2) as pool:
        scatter = np.std(list(pool.map(estimates, range(runs))), axis=0, ddof=1)
    print(f"Expected standard errors and the scatter of {runs} estimates, whole pipe")
    for name, error, spread in zip(ROBOT.names, errors, scatter, strict=True):
        print(f"{name:8}{error:12.3g}{spread:12.3g}{spread / error:8.2f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        expected(Path(folder), given.runs)


if __name__ == "__main__":
    main()
