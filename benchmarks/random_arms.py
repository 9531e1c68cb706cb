"""Arms that nobody has chosen: random chains, each identified blind from one simulated log.

    python benchmarks/random_arms.py [--arms 20] [--first 300]

An arm has two to six axes, a fifth of them prismatic, in any direction, with random links, friction
and motors, and gravity. Its log lasts 4, 8 or 20 s. *Good* are those of that verdict; *wrong* those
of them with an estimate that is more than four stated errors off; *inside* are the estimates within
two. In the last condition the torque constant of one joint but the first is 5 % off, and the log
lasts 20 s; *named* says how often the verdict names this joint, within three stated errors. The
constant of a last joint that carries nearly nothing no log can tell.
"""

from __future__ import annotations

import argparse
import math
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow.parquet as pq
from gains import TOLD

from scarid_cli.algorithms.robots.reading import load

SCARID = Path(sys.executable).parent / "scarid"
RIGHT, OFFSETS, GAIN = "right", "offsets of 0.5 N m", "one constant 5 % off"
TURNS = (0.0, math.pi / 2, -math.pi / 2, math.pi)
LINK = """<link name="l{i}"><inertial><origin xyz="{c[0]} {c[1]} {c[2]}"/><mass value="{m}"/>
<inertia ixx="{J[0][0]}" ixy="{J[0][1]}" ixz="{J[0][2]}" iyy="{J[1][1]}" iyz="{J[1][2]}"
 izz="{J[2][2]}"/></inertial></link>
"""
JOINT = """<joint name="j{i}" type="{kind}"><parent link="l{before}"/><child link="l{i}"/>
<origin xyz="{xyz[0]} {xyz[1]} {xyz[2]}" rpy="{rpy[0]} {rpy[1]} {rpy[2]}"/>
<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>
<limit lower="-3" upper="3" effort="400" velocity="4"/></joint>
"""
MOTOR = """[[joint]]
position_limit = {reach}
velocity_limit = {speed}
acceleration_limit = 8.0
encoder_resolution = 2e-5
torque_noise = {noise:.3g}
terms = {{ viscous = {viscous:.3g}, coulomb = {coulomb:.3g}, inertia = {inertia:.3g} }}
"""


@dataclass(frozen=True)
class Found:
    """What one log said: the verdict, errors over stated ones, and the joint that was named."""

    grade: str
    ratios: np.ndarray
    named: bool


def arm(rng: np.random.Generator, folder: Path) -> int:
    """Write a random arm; the number of its axes."""
    axes, urdf, motors = int(rng.integers(2, 7)), '<link name="l0"/>', ['urdf = "r.urdf"\n']
    for i in range(1, axes + 1):
        slides = rng.random() < 0.2
        oblique = rng.standard_normal(3) if rng.random() < 0.3 else np.eye(3)[rng.integers(3)]
        rpy = rng.choice(TURNS, 3) if rng.random() < 0.7 else rng.uniform(-3.0, 3.0, 3)
        m, A = rng.uniform(0.5, 8.0), rng.standard_normal((3, 3))
        P = 0.005 * m * (A @ A.T / 3.0 + 0.3 * np.eye(3))  # second moments, so that it is a body
        urdf += LINK.format(i=i, c=rng.uniform(-0.15, 0.15, 3), m=m, J=np.trace(P) * np.eye(3) - P)
        urdf += JOINT.format(
            i=i,
            kind="prismatic" if slides else "revolute",
            before=i - 1,
            xyz=rng.uniform(-0.4, 0.4, 3),
            rpy=rpy,
            axis=oblique / np.linalg.norm(oblique),
        )
        motors.append(
            MOTOR.format(
                reach=0.4 if slides else 1.8,
                speed=0.8 if slides else 3.0,
                noise=rng.uniform(0.02, 0.5),
                viscous=rng.uniform(0.1, 3.0),
                coulomb=rng.uniform(0.1, 4.0),
                inertia=rng.uniform(0.01, 0.5),
            )
        )
    (folder / "r.urdf").write_text(f'<robot name="r">{urdf}</robot>')
    (folder / "r.toml").write_text("".join(motors))
    return axes


def identified(condition: str, seed: int) -> Found:
    """The blind identification of one arm."""
    rng = np.random.default_rng(seed)
    with TemporaryDirectory() as name:
        folder = Path(name)
        axes = arm(rng, folder)
        seconds, wrong = rng.choice([4, 8, 20]), int(rng.integers(1, axes))
        errors = ",".join("0.05" if j == wrong else "0" for j in range(axes))
        beyond = {
            RIGHT: "",
            OFFSETS: "--with torque-offset=0.5",
            GAIN: f"--with torque-constant-error={errors}",
        }[condition]
        line = (
            f"trajgen -q --robot r.toml --seed {seed} --duration"
            f" {20 if condition == GAIN else seconds}"
            f" then simulate -q --seed {seed} {beyond} -o log.parquet"
        )
        words = [str(SCARID), *line.split()]
        subprocess.run(words, cwd=folder, check=True, capture_output=True)
        words = [str(SCARID), *["identify", "--robot", "r.toml", "log.parquet", "-o", "p.parquet"]]
        done = subprocess.run(words, cwd=folder, check=True, capture_output=True, text=True)
        rows = pq.read_table(folder / "p.parquet").to_pylist()
        truth = load(str(folder / "r.toml")).apriori
    grade = re.search(r"identify: (good|rough|doubtful|not identifiable)", done.stderr)
    told = TOLD.findall(done.stderr)
    pairs = zip(rows, truth, strict=True)
    return Found(
        grade[1] if grade else "none",
        np.array([abs(row["estimate"] - x) / row["robust_error"] for row, x in pairs]),
        len(told) == 1
        and int(told[0][0]) == wrong + 1
        and abs(float(told[0][1]) - 1.05) <= max(1.5 * float(told[0][2]), 0.006),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--arms", type=int, default=20)
    parser.add_argument("--first", type=int, default=300)
    given = parser.parse_args()
    seeds = range(given.first, given.first + given.arms)
    print(f"{'condition':<22} {'good':>5} {'wrong':>6} {'inside':>7} {'named':>6}  of {len(seeds)}")
    with ThreadPoolExecutor(2) as pool:
        for condition in (RIGHT, OFFSETS, GAIN):
            found = list(pool.map(lambda seed: identified(condition, seed), seeds))  # noqa: B023
            good = [x for x in found if x.grade == "good"]
            wrong = sum(float(x.ratios.max()) > 4.0 for x in good)
            inside = np.mean([np.mean(x.ratios < 2.0) for x in found])
            named = sum(x.named for x in found)
            print(
                f"{condition:<22} {len(good):>5} {wrong:>6} {inside:>7.3f} {named:>6}", flush=True
            )


if __name__ == "__main__":
    main()
