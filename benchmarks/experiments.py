"""Are the expected errors of a planned experiment met? On the simulated SCARA, by whole pipes.

    python benchmarks/experiments.py --runs 200

Each experiment is the shell pipe that a user would type: `scarid trajgen`, `simulate`,
`differentiate` and `identify --estimator wls --drop-slow 0.1 --align`. The table compares the
errors that `trajgen --expected` predicts with the scatter of the estimates over simulated logs of
one motion, and with their root-mean-square errors, estimate less true value.
"""

from __future__ import annotations

import argparse
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from shells import column, shell

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

ROBOT = load("scara2")
ROWS = "--drop-slow 0.1 --align"  # how `identify` treats them, and `trajgen` expects it
IDENTIFY = f"scarid differentiate | scarid identify -q --estimator wls {ROWS}"


def expected(folder: Path, runs: int) -> None:
    """The expected error of each parameter and the scatter of its estimates over the runs."""
    plan = f"scarid trajgen -q --seed 1 {ROWS} --expected errors.csv -o reference.parquet"
    errors = column(shell(folder, f"{plan}; cat errors.csv"), "expected_error", ROBOT.names)

    def estimates(seed: int) -> Array:
        line = f"scarid simulate --seed {seed} --format arrow reference.parquet | {IDENTIFY}"
        return column(shell(folder, line), "estimate", ROBOT.names)

    with ThreadPoolExecutor(2) as pool:
        found = np.array(list(pool.map(estimates, range(runs))))
    scatter = found.std(axis=0, ddof=1)
    rms = np.sqrt(np.mean((found - ROBOT.apriori) ** 2, axis=0))
    print(f"Expected standard errors, and the scatter and errors of {runs} estimates, whole pipe")
    for name, *row in zip(
        ROBOT.names, errors, scatter, rms, scatter / errors, rms / errors, strict=True
    ):
        print("{:8}{:12.3g}{:12.3g}{:12.3g}{:8.2f}{:8.2f}".format(name, *row))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        expected(Path(folder), given.runs)


if __name__ == "__main__":
    main()
