"""Optimised excitations over several robots: condition numbers, expected errors, CPU time.

    python benchmarks/excitation.py                 # every robot, ten seeds of six starts
    python benchmarks/excitation.py --seconds 120   # the smallest condition number of the UR10e

Robots whose URDF is not in the repository are read from ../shared/data/urdf where they exist.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median

import numpy as np

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.algorithms.design.constraints import Torque
from scarid_cli.algorithms.design.model import Model
from scarid_cli.algorithms.design.prediction import Moments, standard_errors
from scarid_cli.algorithms.design.problem import Wanted, margins
from scarid_cli.algorithms.design.search import search
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.arrays import Array

ROOT = Path(__file__).parent.parent
URDFS = ROOT.parent / "shared/data/urdf"
UR10E_HOME = np.array([0.0, -np.pi / 2, 0.0, -np.pi / 2, 0.0, 0.0])
DURATION, COARSE = 20.0, 5.0  # s; samples per second, as published figures have them
RANDOM = 10  # random motions of each kind
OPTIMISED = (
    ("balanced", "spline"),
    ("balanced", "fourier"),
    ("d", "spline"),
    ("a", "spline"),
    ("c", "spline"),
    ("scaled-c", "spline"),
)
ACCELERATION = 5.0  # of robots whose description has no limit


def robots() -> Iterator[tuple[str, Robot, Limits, Array]]:
    """The robots with their limits and home."""
    paths = [ROOT / "samples/robots/ur10e.toml", *sorted(URDFS.glob("*.urdf"))]
    for name in ["scara2", *map(str, paths)]:
        robot = load(name)
        own = Limits.of(robot.joints)
        lower, upper = np.maximum(own.lower, -np.pi), np.minimum(own.upper, np.pi)
        hard = np.where(np.isfinite(own.ddq), own.ddq, ACCELERATION)
        limits = Limits(lower, upper, np.minimum(own.dq, 10.0), hard)
        yield Path(name).stem, robot, limits, UR10E_HOME if "ur10e" in name else limits.home


def noise_of(robot: Robot) -> Array:
    """The noise of the torques (joints); 1 where it is not known."""
    return np.array([joint.torque_noise or 1.0 for joint in robot.joints])


def wish(robot: Robot, limits: Limits, home: Array, criterion: str, excitation: str) -> Wanted:
    """An optimised motion of this duration."""
    model = Model.of(robot)
    torques = np.array([joint.torque_limit for joint in robot.joints])
    laws = (Torque(model, torques),) if np.isfinite(torques).any() else ()
    noise = noise_of(robot)
    basis = EXCITATIONS.load(excitation)().basis(limits, DURATION)
    known = np.zeros((len(model.theta), len(model.theta)))
    return Wanted(model, basis, home, limits, laws, criterion, noise, 200.0, known)


def measured(robot: Robot, motion: Trajectory, noise: Array) -> tuple[float, float, float]:
    """Condition numbers of W and its scaled columns, and the geometric mean of expected errors."""
    t = np.arange(0.0, DURATION + 1e-9, 1.0 / COARSE)
    coarse = Moments.of([robot.regressor(*motion.sample(t))]).conditions
    t = np.arange(0.0, DURATION, 0.005)
    errors = standard_errors(Moments.of([robot.regressor(*motion.sample(t))]).information(noise))
    known = errors[np.isfinite(errors)]
    return *coarse, float(np.exp(np.log(known).mean()))


def row(
    name: str, what: str, found: list[tuple[float, float, float]], seconds: str, usual: float = 1.0
) -> None:
    """Print a line of the table, with errors relative to usual ones."""
    plain, scaled, errors = (sorted(column) for column in zip(*found, strict=True))
    print(
        f"| {name} | {what} | {median(plain):.3g} ({plain[0]:.3g} to {plain[-1]:.3g}) "
        f"| {median(scaled):.3g} | {median(errors) / usual:.3g} | {seconds} |",
        flush=True,
    )


def compare(seeds: int, starts: int) -> None:
    """Every robot, random and optimised, by every criterion.

    Mean errors are relative to those of the default random motion.
    """
    print("| robot | motion | condition number | scaled | mean error | s each |")
    print("|---|---|---|---|---|---|")
    for name, robot, limits, home in robots():
        usual = randoms(name, robot, limits, home)
        for criterion, kind in OPTIMISED:
            wanted = wish(robot, limits, home, criterion, kind)
            began, found = time.monotonic(), []
            for seed in range(seeds):
                curve = search(wanted, seed, starts, 0.0, lambda: None).curve
                t = np.arange(0.0, DURATION, 1e-3)
                limits.require(t, *curve.sample(t))
                assert all(m.max() <= 0.0 for m in margins(curve, wanted.laws))
                found.append(measured(robot, curve, wanted.noise))
            each = (time.monotonic() - began) / seeds
            row(name, f"{kind}, {criterion}", found, f"{each:.1f}", usual)


def randoms(name: str, robot: Robot, limits: Limits, home: Array) -> float:
    """The rows of random motions; the mean error of the default one."""
    usual = 0.0
    for kind in ("quintic", "spline", "fourier"):
        excitation = EXCITATIONS.load(kind)()
        motions = (
            excitation.trajectory(limits, home, DURATION, np.random.default_rng(seed))
            for seed in range(RANDOM)
        )
        found = [measured(robot, motion, noise_of(robot)) for motion in motions]
        usual = usual or median(errors for *_, errors in found)
        row(name, f"random {kind}", found, "", usual)
    return usual


def timed(seconds: float, seeds: int) -> None:
    """The UR10e within a budget."""
    _, robot, limits, home = next(r for r in robots() if r[0] == "ur10e")
    for criterion in ("balanced", "c"):
        wanted = wish(robot, limits, home, criterion, "spline")
        found, began = [], time.monotonic()
        for seed in range(seeds):
            best = search(wanted, seed, None, seconds, lambda: None)
            found.append(measured(robot, best.curve, wanted.noise))
        each = (time.monotonic() - began) / seeds
        row("ur10e", f"{criterion}, {best.starts} starts", found, f"{each:.1f}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--starts", type=int, default=6)
    parser.add_argument("--seconds", type=float, help="a budget for the UR10e instead")
    given = parser.parse_args()
    if given.seconds:
        timed(given.seconds, given.seeds)
    else:
        compare(given.seeds, given.starts)


if __name__ == "__main__":
    main()
