"""Payloads of arms that are not ideal: `make bench-payloads`.

    python benchmarks/payloads.py --runs 100

Each run is a random motion of 20 s under one condition of the gauntlet, with the bare robot and
with a payload of 0.2 to 5 kg, whose centre is up to 10 cm from the last axis in each direction and
whose inertia is that of a box of 5 to 20 cm. Both logs have the same motion, the same imperfection
and other noise; they are identified blindly, and `scarid payload` says the ten values. The columns
are the median errors of mass [%] and centre [mm], beside the medians of half the intervals; the
share of the told intervals that contain the truth, of mass, centre and inertia; the runs that say
nothing; and those that are `wrong`: both verdicts are good, and a value is off by as many stated
errors as are as rare for one of ten values as three for a single one.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import NormalDist
from subprocess import CalledProcessError

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from arms import URDFS, described
from conditions import CONDITIONS, UNSEEN, Condition, log, robot_named
from shells import shell

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.interval import HALF
from scarid_cli.stages.payload import frame_of

EVERY = {c.name: c for c in (*CONDITIONS, *UNSEEN)}
# What makes another robot than that of the description, or holds a load of its own.
OTHERS = ("payload", "link length", "gain of")
FAR = NormalDist().inv_cdf(1.0 - 0.5 * (1.0 - (2.0 * NormalDist().cdf(3.0) - 1.0) ** 0.1))
GROUPS = {"mass": slice(0, 1), "centre": slice(1, 4), "inertia": slice(4, 10)}


@dataclass(frozen=True)
class Run:
    """Of the ten values: the errors made, and those stated, nan where one is not told."""

    condition: str
    mass: float
    off: Array
    stated: Array
    verdicts: tuple[str, ...]


def body(rng: np.random.Generator) -> tuple[float, Array, Array]:
    """Mass [kg], centre [m] in the frame of the last axis, inertia about it [kg m2] (3, 3)."""
    mass = float(np.exp(rng.uniform(np.log(0.2), np.log(5.0))))
    centre = rng.uniform(-0.1, 0.1, 3)
    x, y, z = rng.uniform(0.05, 0.2, 3) ** 2
    turn, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    return mass, centre, turn @ np.diag([y + z, x + z, x + y]) @ turn.T * mass / 12.0


def in_the_tool(robot: Robot, mass: float, centre: Array, inertia: Array) -> Array:
    """The ten values of a body, given in the frame of the last axis, in that of the tool."""
    frame, _ = frame_of(robot, None, "")
    own = frame.turn.T @ inertia @ frame.turn
    return np.array([mass, *frame.turn.T @ (centre - frame.origin), *own[np.triu_indices(3)]])


def written(robot: Robot, condition: Condition, seed: int, noise: int, path: Path) -> None:
    """A log as people have it: a clock, positions and torques."""
    table = log(robot, condition, seed, noise=noise)
    numbers = range(1, len(robot.joints) + 1)
    columns = ["t", *(f"{s}{i}" for s in ("q", "tau") for i in numbers)]
    pq.write_table(pa.Table.from_batches(list(table.batches)).select(columns), path)


def run(name: str, condition: str, seed: int) -> Run:
    """One payload."""
    robot, given = robot_named(name), EVERY[condition]
    mass, centre, inertia = body(np.random.default_rng(seed))
    upper = inertia[np.triu_indices(3)]
    loaded = {**given.given, "payload": (mass, *centre, *upper, 0.0)}
    truth = in_the_tool(robot, mass, centre, inertia)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        described(URDFS / f"{name}.urdf", folder)
        written(robot, given, seed, seed, folder / "bare.parquet")
        written(robot, replace(given, given=loaded), seed, seed + 5000, folder / "loaded.parquet")
        try:
            text = shell(
                folder,
                "export SCARID_ROBOT=arm.toml OMP_NUM_THREADS=1;"
                "scarid identify -q bare.parquet --json -o known.parquet > bare.json;"
                "scarid payload --parameters known.parquet loaded.parquet --json 2> said",
            )
        except CalledProcessError:
            why = (folder / "said").read_text() if (folder / "said").exists() else ""
            print(f"{name}, {condition}, {seed}: {why}")
            nothing = np.full(10, np.nan)
            return Run(condition, mass, nothing, nothing, ("refused",))
        bare = json.loads((folder / "bare.json").read_text())["verdict"]
        said = (folder / "said").read_text()
    grade = said.split("the loaded robot: ")[1].split(":")[0] if "the loaded" in said else "?"
    values = json.loads(text)["values"]
    found = [(x["estimate"], x["half_interval"]) for x in values]
    estimates, half = np.array(found, dtype=float).T
    return Run(condition, mass, estimates - truth, half / HALF, (bare, grade))


def row(name: str, runs: list[Run]) -> str:
    """A line of the table."""
    off, stated = np.array([r.off for r in runs]), np.array([r.stated for r in runs])
    told = np.isfinite(off) & np.isfinite(stated)
    inside = np.abs(off) <= HALF * stated
    masses = np.array([r.mass for r in runs])
    known = told[:, 0]
    mass = 100.0 * np.median(np.abs(off[known, 0]) / masses[known])
    half = 100.0 * np.median(HALF * stated[known, 0] / masses[known])
    centres = np.linalg.norm(off[:, 1:4], axis=1)
    spread = np.linalg.norm(HALF * stated[:, 1:4], axis=1)
    cover = [100.0 * inside[:, g][told[:, g]].mean() for g in GROUPS.values()]
    good = np.array([set(r.verdicts) <= {"good"} for r in runs])
    wrong = good & np.any(told & (np.abs(off) > FAR * stated), axis=1)
    return (
        f"{name:<34}{len(runs):>5}{mass:>7.2f}{half:>6.2f}"
        f"{1e3 * np.nanmedian(centres):>8.1f}{1e3 * np.nanmedian(spread):>6.1f}"
        + "".join(f"{x:>8.0f}" for x in cover)
        + f"{100 * (~known).mean():>6.0f}{100 * good.mean():>6.0f}{100 * wrong.mean():>7.0f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default="ur10,panda")
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=90_000)
    parser.add_argument("--conditions", help="by default all of the gauntlet, in turn")
    given = parser.parse_args()
    names = [n for n in EVERY if not any(word in n for word in OTHERS)]
    if given.conditions:
        names = given.conditions.split(",")
    print(
        f"{'':<34}{'runs':>5}{'mass %':>13}{'centre mm':>14}{'inside %: mass':>16}"
        f"{'centre':>8}{'inertia':>8} none  good  wrong"
    )
    with ProcessPoolExecutor(2) as pool:
        for robot in given.robots.split(","):
            seeds = range(given.seed, given.seed + given.runs)
            chosen = [names[i % len(names)] for i in range(given.runs)]
            runs = list(pool.map(run, [robot] * given.runs, chosen, seeds))
            for name in dict.fromkeys(chosen):
                own = [r for r in runs if r.condition == name]
                if np.isfinite([r.off[0] for r in own]).any():
                    print(row(name, own), flush=True)
            print(row(robot, runs), flush=True)


if __name__ == "__main__":
    main()
