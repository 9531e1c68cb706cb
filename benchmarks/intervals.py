"""The intervals of two versions of scarid on the same clean logs of the gauntlet.

    git worktree add ../before b967de9 && make -C ../before .venv/tested
    python benchmarks/intervals.py ../before/.venv/bin/scarid

The other version identifies by `scarid differentiate LOG | scarid identify`, the default of
versions that have no recommended procedure; this one by `scarid identify LOG`. *Width* is the
median ratio of the widths of the 95 % intervals, this version's over the other's, over all logs and
parameters, and *covered* are the intervals that contain the true value, of the other version and of
this one [%].
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
from arms import URDFS, described
from conditions import CONDITIONS, log, robot_named, truth_of
from shells import column, shell

from scarid_cli.arrays import Array

LOGS = {"scara2": 40, "planar2-gravity": 40, "ur10": 8, "panda": 6}
SEED = 30_000
(CLEAN,) = (condition for condition in CONDITIONS if condition.name == "clean")


def pairs(name: str, before: Path, seeds: range) -> Array:
    """The limits (2 versions, logs, 2, parameters) by the other version and by this one."""
    robot = robot_named(name)
    found = []
    with tempfile.TemporaryDirectory() as temporary:
        folder, arm = Path(temporary), name
        if (URDFS / f"{name}.urdf").exists():
            arm = str(described(URDFS / f"{name}.urdf", folder))
        for seed in seeds:
            measured = pa.Table.from_batches(list(log(robot, CLEAN, seed).batches))
            pa.csv.write_csv(measured, folder / "log.csv")
            lines = (
                f"{before} differentiate -q log.csv | {before} identify -q --robot {arm}",
                f"scarid identify -q --robot {arm} log.csv",
            )
            tables = [shell(folder, line) for line in lines]
            ends = [[column(x, end, robot.names) for end in ("low", "high")] for x in tables]
            found.append(ends)
    return np.array(found).swapaxes(0, 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("before", type=Path, help="the command of the other version")
    given = parser.parse_args()
    print(f"{'':18}{'width':>7}{'covered before':>16}{'now':>6}")
    for name, count in LOGS.items():
        both = pairs(name, given.before.absolute(), range(SEED, SEED + count))
        old, new = (x[:, 1] - x[:, 0] for x in both)
        truth = truth_of(robot_named(name), CLEAN)
        inside = [100.0 * np.mean((x[:, 0] <= truth) & (truth <= x[:, 1])) for x in both]
        width = np.nanmedian(new / old)
        print(f"{name:18}{width:7.2f}{inside[0]:16.0f}{inside[1]:6.0f}", flush=True)


if __name__ == "__main__":
    main()
