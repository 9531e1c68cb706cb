"""A base that leans: whether one log tells it, and what is then estimated.

`python benchmarks/tilts.py [--seeds 20] [--first 100] [--duration 20]`: logs of random motions of a
UR10e whose base leans by an angle in a random direction, identified as if it stood upright.
`named`: the verdict names another direction of gravity; `off`: the median distance between the
stated direction and the true one [deg]; `good`, and `wrong`: called good, and a parameter further
than four stated errors from the truth; `gains`: the gain of a joint is called wrong, which is
right; `inside`: the intervals that contain the truth; `torque`: the median error of the torque on
another motion of the upright robot [%].
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import repeat
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from conditions import Condition, log
from gauntlet import blind_of, relative_error

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load

UPRIGHT = Path(__file__).parent.parent / "samples" / "robots" / "ur10e.toml"
DEGREES = (0.0, 1.0, 2.0, 5.0, 10.0)
STATED = re.compile(r"state gravity = \[(.*?)\]")


@dataclass(frozen=True)
class Found:
    """What is said of a log, and how far it is off."""

    named: bool
    off: float
    good: bool
    wrong: bool
    gains: bool
    inside: float
    torque: float


def leaning(degrees: float, seed: int) -> Robot:
    """The robot on a base that leans in a random direction, with the parameters that this shows."""
    towards, lean = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi), np.deg2rad(degrees)
    side = np.sin(lean) * np.array([np.cos(towards), np.sin(towards)])
    gravity = 9.81 * np.array([*side, -np.cos(lean)])
    text = UPRIGHT.read_text("utf-8").replace('"ur10e.urdf"', f'"{UPRIGHT.with_suffix(".urdf")}"')
    with TemporaryDirectory() as folder:
        path = Path(folder) / "leaning.toml"
        path.write_text(f"gravity = {gravity.tolist()}\n{text}", "utf-8")
        return load(str(path))


def case(degrees: float, seed: int, duration: float) -> Found:
    """One log, identified as one of an upright robot."""
    upright = load(str(UPRIGHT))
    real = leaning(degrees, seed)
    measured = log(real, Condition("leans", duration=duration), seed)
    result, _ = blind_of(upright, measured)
    (batch,) = result.batches
    estimates, errors, low, high = (
        batch.column(c).to_numpy(zero_copy_only=False)
        for c in ("estimate", "robust_error", "low", "high")
    )
    truth, known = upright.apriori, np.isfinite(errors)
    away = np.max(np.abs(estimates - truth)[known] / errors[known])
    said = "; ".join(result.meta.extra["reasons"])
    stated = STATED.search(said)
    gravity = np.array([float(x) for x in stated[1].split(",")]) if stated else np.full(3, np.nan)
    true = np.array(real.body.gravity) if real.body else gravity
    cosine = gravity @ true / np.linalg.norm(gravity) / np.linalg.norm(true)
    W = upright.regressor(*motion(upright, seed + 1000))
    good = result.meta.extra["verdict"] == "good"
    return Found(
        named=stated is not None,
        off=float(np.rad2deg(np.arccos(min(cosine, 1.0)))),
        good=good,
        wrong=good and bool(away > 4.0),
        gains="do not fit together" in said,
        inside=float(np.mean((low <= truth)[known] & (truth <= high)[known])),
        torque=100.0 * relative_error(W @ (estimates - truth), W @ truth),
    )


def motion(robot: Robot, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, velocities and accelerations (joints, samples) of some poses."""
    rng, n = np.random.default_rng(seed), len(robot.joints)
    return rng.uniform(-2, 2, (n, 500)), rng.uniform(-1, 1, (n, 500)), rng.uniform(-3, 3, (n, 500))


def line(degrees: float, found: Sequence[Found]) -> str:
    """A row of the table, most of which docs/errors.md shows."""
    counts = [sum(getattr(x, name) for x in found) for name in ("named", "good", "wrong", "gains")]
    offs = [x.off for x in found if x.named]
    off = f"{np.median(offs):.2g}" if offs else ""
    inside, torque = np.mean([x.inside for x in found]), np.median([x.torque for x in found])
    cells = f"{counts[0]} | {off} | {counts[1]} | {counts[2]} | {counts[3]}"
    return f"| {degrees:g} | {cells} | {100.0 * inside:.1f} | {torque:.2g} |"


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=100)
    parser.add_argument("--duration", type=float, default=20.0)
    given = parser.parse_args()
    print("| leans by [deg] | named | off [deg] | good | wrong | gains | inside [%] | torque [%] |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    seeds = range(given.first, given.first + given.seeds)
    with ProcessPoolExecutor(2) as pool:
        for degrees in DEGREES:
            found = pool.map(case, repeat(degrees), seeds, repeat(given.duration))
            print(line(degrees, [*found]), flush=True)


if __name__ == "__main__":
    main()
