"""The gain of each joint from a load whose mass is known: is it within its interval, and named?

`python benchmarks/known_load.py [--robot ur10e] [--seeds 50]`: motions of 20 s, a load of 1 to 5 kg
of which only the mass is stated, and two torque constants that are off by 5 to 40 %, up or down.
`told` are the gains that the motion tells, of all; `within` those of them in their 95 % intervals;
`runs` the runs of which all are; `median half` half the interval. `named` are the wrong constants
that are called wrong, of those that are told, and `false` the right ones. With `--free` the bare
robot is identified with --free-gains 2, which makes the residuals those of the noise.
The seven-axis arm is that of ../shared/data/urdf.
"""

from __future__ import annotations

import argparse
import csv
import io
import json
import tempfile
from pathlib import Path

import numpy as np
from arms import URDFS, described
from shells import shell

from scarid_cli.algorithms.robots.reading import load

ROOT = Path(__file__).parent.parent
UR10E = ROOT / "samples/robots/ur10e.toml"


def case(folder: Path, robot: Path, seed: int, free: str) -> tuple[list[dict[str, str]], object]:
    """The rows of the table of gains, with the true gain of each, and the joints called wrong."""
    rng = np.random.default_rng(seed)
    joints = len(load(str(robot)).joints)
    true = np.ones(joints)
    off = rng.choice(joints, 2, replace=False)
    true[off] = (1.0 + rng.uniform(0.05, 0.4, 2)) ** rng.choice((-1.0, 1.0), 2)
    mass = round(float(rng.uniform(1.0, 5.0)), 3)
    x, y, z = rng.uniform((-0.05, -0.05, 0.0), (0.05, 0.05, 0.15))
    body = f"{mass},{x},{y},{z},{0.01 * mass},0,0,{0.01 * mass},0,{0.01 * mass},0"
    error = ",".join(f"{k - 1.0:.12g}" for k in true)
    made = f"--robot {robot} --with torque-constant-error={error}"
    shell(
        folder,
        f"scarid trajgen -q --robot {robot} --seed {seed} --duration 20 -o ref.parquet;"
        f"scarid simulate -q {made} --seed {seed} ref.parquet -o bare-log.parquet;"
        f"scarid simulate -q {made} --seed {1000 + seed} --with payload={body} ref.parquet"
        " -o loaded.parquet;"
        f"scarid identify -q --robot {robot} {free} bare-log.parquet -o bare.parquet",
    )
    text = shell(
        folder,
        f"scarid gains -q --robot {robot} --parameters bare.parquet --mass {mass} loaded.parquet"
        " --json -o gains.csv",
    )
    table = csv.DictReader(io.StringIO((folder / "gains.csv").read_text()))
    rows = [{**row, "true": k} for row, k in zip(table, true, strict=True)]
    return rows, json.loads(text)["wrong"]


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--robot", choices=("ur10e", "xarm7"), default="ur10e")
    parser.add_argument("--seeds", type=int, default=50)
    parser.add_argument("--free", action="store_true")
    given = parser.parse_args()
    told = within = runs = named = right = false = others = 0
    halves, errors = [], []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        robot = UR10E if given.robot == "ur10e" else described(URDFS / "xarm7.urdf", folder)
        for seed in range(1, given.seeds + 1):
            rows, wrong = case(folder, robot, seed, "--free-gains 2" if given.free else "")
            known = [row for row in rows if row["gain"]]
            inside = [float(x["low"]) <= x["true"] <= float(x["high"]) for x in known]
            told += len(known)
            within += sum(inside)
            runs += all(inside)
            for row in known:
                halves.append(0.5 * (float(row["high"]) - float(row["low"])) / row["true"])
                errors.append(abs(float(row["gain"]) / row["true"] - 1.0))
                called = int(row["joint"]) in wrong
                named += called and row["true"] != 1.0
                right += row["true"] != 1.0
                false += called and row["true"] == 1.0
                others += row["true"] == 1.0
            if not all(inside):
                print(seed, [x for x, ok in zip(known, inside, strict=True) if not ok], flush=True)
    print(
        f"{given.robot}: told {told} of {given.seeds * len(rows)}, within {within}, runs {runs} of "
        f"{given.seeds}, median half {100 * np.median(halves):.2g} %, median error "
        f"{100 * np.median(errors):.2g} %, named {named} of {right}, false {false} of {others}"
    )


if __name__ == "__main__":
    main()
