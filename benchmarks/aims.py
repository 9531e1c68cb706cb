"""What `trajgen --for gains` and `--for payload` are worth: the errors of what is then estimated.

`python benchmarks/aims.py [--robot FILE] [--seeds 5]`: motions of 20 s of the UR10e, random,
balanced, and planned for the gains or for a payload; of each the pipe that a user would type, with
a load of 1 kg in the `payload`'s frame. Each cell is the root-mean-square over seeds: of the errors
made, estimate less true value, and of the half 95 % intervals that are stated. Gains: of the joints
that every motion tells, in per cent. A new seed is another motion and other noise.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
from payloads import GROUPS, in_the_tool
from shells import shell

from scarid_cli.algorithms.robots.reading import load
from scarid_cli.interval import HALF

ROOT = Path(__file__).parent.parent
UR10E = ROOT / "samples/robots/ur10e.toml"
PLANS = {
    "random": "",
    "balanced": "--optimise --starts 4",
    "gains": "--optimise --starts 4 --for gains",
    "payload": "--optimise --starts 4 --for payload",
}
BODY = "1,0,0,0,0.004,0,0,0.004,0,0.004,0"
UNITS = {"mass": "g", "centre": "mm", "inertia": "g m2"}

Cells = dict[str, tuple[float, float]]


def case(robot: str, plan: str, seed: int) -> Cells:
    """The error made and the one stated, of each quantity."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = shell(
            folder,
            f"scarid trajgen -q {robot} --seed {seed} {PLANS[plan]} -o motion.parquet;"
            f"scarid simulate -q {robot} --seed {seed} motion.parquet -o log.parquet;"
            f"scarid simulate -q {robot} --seed {500 + seed} --with payload={BODY} motion.parquet"
            " -o loaded.parquet;"
            f"scarid identify -q {robot} log.parquet --free-gains 2 -o free.parquet;"
            f"scarid identify -q {robot} log.parquet -o bare.parquet;"
            f"scarid payload -q {robot} --parameters bare.parquet loaded.parquet --json",
        )
        extra = json.loads(pq.read_schema(folder / "free.parquet").metadata[b"scarid"])["extra"]
    cells = {
        f"gain {joint} [%]": (
            100.0 * (extra["torque_gains"][int(joint) - 1] - 1.0),
            100.0 * HALF * error,
        )
        for joint, (_, error) in extra["relative_gains"].items()
    }
    values = json.loads(text)["values"]
    found = np.array([(x["estimate"], x["half_interval"]) for x in values], dtype=float)
    own = load(robot.removeprefix("--robot "))
    found[:, 0] -= in_the_tool(own, 1.0, np.zeros(3), 0.004 * np.eye(3))
    for group, rows in GROUPS.items():
        away, half = 1e3 * np.sqrt(np.mean(found[rows] ** 2, axis=0))
        cells[f"{group} [{UNITS[group]}]"] = (float(away), float(half))
    return cells


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", default=str(UR10E))
    parser.add_argument("--seeds", type=int, default=5)
    given = parser.parse_args()
    robot = f"--robot {given.robot}"
    seeds = range(1, given.seeds + 1)
    tables: dict[str, list[Cells]] = {}
    with ThreadPoolExecutor(2) as pool:
        for plan in PLANS:
            tables[plan] = list(pool.map(lambda s: case(robot, plan, s), seeds))  # noqa: B023
    names = [n for n in tables["gains"][0] if all(n in c for t in tables.values() for c in t)]
    print(f"{'made/stated':<18}" + "".join(f"{plan:>16}" for plan in PLANS))
    for name in names:
        made = {p: np.array([c[name] for c in cells]) for p, cells in tables.items()}
        rms = {p: np.sqrt(np.mean(x**2, axis=0)) for p, x in made.items()}
        print(f"{name:<18}" + "".join(f"{a:>8.2g}/{b:<7.2g}" for a, b in rms.values()))


if __name__ == "__main__":
    main()
