"""The torque of one joint in another unit: whether one log tells it, and what is then estimated.

`python benchmarks/gains.py [--seeds 20] [--joint 2]`: logs of 20 s of random motions, the torque
of a joint multiplied by a factor. `named`: the verdict names the gain, within twice its half
interval; `wrong`: called good, and an inertia or first moment is further than three stated errors
from the truth.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow.parquet as pq

from scarid_cli.algorithms.robots.reading import load

SCARID = Path(sys.executable).parent / "scarid"
FACTORS = (1.0, 1.02, 1.05, 1.1, 1.3558, 0.7)
SIX = Path(__file__).parent.parent / "samples" / "robots" / "ur10e.toml"
ROBOTS = {"scara2": "", "planar2-gravity": "--q-max 2,2 --ddq-max 20,30", str(SIX): ""}
TOLD = re.compile(r"that of joint (\d) is (\S+) \+- (\S+) times")


def shell(line: str, folder: Path) -> str:
    done = subprocess.run(
        line.replace("scarid ", f"{SCARID} "), shell=True, cwd=folder, check=True,
        capture_output=True, text=True,
    )  # fmt: skip
    return done.stderr


def case(robot: str, joint: int, seed: int, factor: float) -> tuple[str, bool, bool]:
    """The grade, whether the gain was named rightly, and whether good estimates are wrong."""
    joints = len(load(robot).joints)
    with TemporaryDirectory() as name:
        folder = Path(name)
        told = shell(
            f"scarid trajgen -q --robot {robot} --seed {seed} {ROBOTS[robot]} --duration 20 |"
            f" scarid simulate -q --robot {robot} --seed {seed} --format csv |"
            f" cut -d, -f-{2 * joints + 1} |"
            f" awk -F, -v OFS=, 'NR > 1 {{ ${joints + 1 + joint} *= {factor} }} 1' > log.csv;"
            f" scarid identify --robot {robot} log.csv -o p.parquet",
            folder,
        )
        rows = {row["parameter"]: row for row in pq.read_table(folder / "p.parquet").to_pylist()}
    grade = re.search(r"scarid identify: (good|rough|doubtful|not identifiable)", told)
    found = TOLD.search(told)
    named = False
    if found:
        true = factor if found[1] == str(joint) else 1.0 / factor
        named = abs(float(found[2]) - true) <= 2.0 * float(found[3])
    truth = {p.name: p.apriori for p in load(robot).parameters if p.unit in ("kg m2", "kg m")}
    away = [abs(rows[k]["estimate"] - x) / rows[k]["robust_error"] for k, x in truth.items()]
    good = grade is not None and grade[1] == "good"
    return grade[1] if grade else "none", named, good and max(away) > 3.0


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--joint", type=int, default=2)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    given = parser.parse_args()
    seeds = range(1, given.seeds + 1)
    print(f"{'robot':<16} {'factor':>7} {'good':>5} {'named':>6} {'wrong':>6}  of {len(seeds)}")
    with ThreadPoolExecutor(2) as pool:
        for robot in given.robots.split(","):
            for factor in FACTORS:
                one = partial(case, robot, given.joint, factor=factor)
                done = list(pool.map(one, seeds))
                good = sum(grade == "good" for grade, _, _ in done)
                named, wrong = (sum(x[k] for x in done) for k in (1, 2))
                print(
                    f"{Path(robot).stem:<16} {factor:>7} {good:>5} {named:>6} {wrong:>6}",
                    flush=True,
                )


if __name__ == "__main__":
    main()
