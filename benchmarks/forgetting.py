"""Variable forgetting beside constant factors: `python benchmarks/forgetting.py`.

Simulated robots whose friction warms up, whose friction jumps, that pick up a payload and put it
down again, and that stay as they are. The error is that of the running estimates, as a torque:
|W (theta_hat - theta)| / |W theta|, as a root mean square over the log from 5 s on, the median
over the seeds. *No forgetting* is `rls`, *best factor* that of the constant factors which is best
for the condition in hindsight.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.choices.registry import ESTIMATORS, EXCITATIONS
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

H, DURATION, FROM = 0.005, 120.0, 5.0  # s
MEMORIES = (0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0)  # s, of the constant factors
METHODS = ("adaptive",)
COLOURED = 0.1  # s


def friction(robot: Robot) -> Array:
    return np.array([p.term.NEVER_NEGATIVE for p in robot.parameters])


def constant(robot: Robot, t: Array) -> Array:
    return np.tile(robot.apriori, (len(t), 1))


def warming(robot: Robot, t: Array) -> Array:
    """Friction falls by 30 % within a minute."""
    factor = 1.0 - 0.3 * (1.0 - np.exp(-t / 60.0))
    return constant(robot, t) * np.where(friction(robot), factor[:, None], 1.0)


def jumping(robot: Robot, t: Array) -> Array:
    """Friction rises by a half, at once."""
    factor = 1.0 + 0.5 * (t > 50.0)
    return constant(robot, t) * np.where(friction(robot), factor[:, None], 1.0)


def carrying(robot: Robot, t: Array) -> Array:
    """A fifth more inertia of the last link from 40 s to 80 s."""
    own = np.array([p.name in ("ZZ2", "L1MX2", "MX2", "M") for p in robot.parameters])
    factor = 1.0 + 0.2 * ((t > 40.0) & (t < 80.0))
    return constant(robot, t) * np.where(own, factor[:, None], 1.0)


Truth = Callable[[Robot, Array], Array]
CONDITIONS: dict[str, Truth] = {
    "constant": constant,
    "friction warms up": warming,
    "friction jumps": jumping,
    "payload up and down": carrying,
}


@dataclass(frozen=True)
class Log:
    rows: Rows
    theta: Array  # (samples, parameters)


def log(name: str, truth: Truth, seed: int) -> Log:
    robot = load(name)
    limits = Limits.of(robot.joints)
    wide = Limits(
        np.where(np.isfinite(limits.lower), limits.lower, -2.0),
        np.where(np.isfinite(limits.upper), limits.upper, 2.0),
        np.minimum(limits.dq, 10.0),
        np.minimum(limits.ddq, 20.0),
    )
    rng = np.random.default_rng(seed)
    excitation = EXCITATIONS.load("quintic")()
    motion = excitation.trajectory(wide, wide.home, DURATION, rng)
    t = np.arange(0.0, DURATION, H)
    q, dq, ddq = motion.sample(t)
    W = robot.regressor(q, dq, ddq)
    theta = truth(robot, t)
    tau = np.einsum("sjp,sp->js", W, theta)
    size = 0.02 * np.sqrt(np.mean(tau**2, axis=1, keepdims=True))
    white = rng.standard_normal((2, *tau.shape))
    keep = np.exp(-H / COLOURED)
    slow = np.zeros_like(tau)
    for k in range(1, tau.shape[1]):
        slow[:, k] = keep * slow[:, k - 1] + np.sqrt(1.0 - keep**2) * white[1][:, k]
    tau += size * (white[0] + slow)
    return Log(rows_of(robot, np.stack((q, dq, ddq, tau)), np.arange(len(t)), H), theta)


def error(name: str, made: Log, method: str, **settings: float) -> tuple[float, float]:
    """The error of the running estimates, and the time [s] they took."""
    robot = load(name)
    estimator = ESTIMATORS.load(method)(**settings).for_robot(robot)
    start = time.process_time()
    _, found = estimator.step(estimator.init(np.zeros(len(robot.names))), made.rows, trace=True)
    took = time.process_time() - start
    late = slice(round(FROM / H), None)
    W, theta = made.rows.W[late], made.theta[late]
    off = np.einsum("sjp,sp->sj", W, found[late] - theta)
    size = np.einsum("sjp,sp->sj", W, theta)
    shares = np.sqrt(np.mean(off**2, axis=0) / np.mean(size**2, axis=0))
    return float(np.mean(shares)), took


def row(name: str, condition: str, seeds: range) -> str:
    logs = [log(name, CONDITIONS[condition], seed) for seed in seeds]
    plain = [error(name, one, "rls") for one in logs]
    factors = [1.0 - H / memory for memory in MEMORIES]
    tried = [
        np.median([error(name, one, "rls", forgetting=factor)[0] for one in logs])
        for factor in factors
    ]
    best = int(np.argmin(tried))
    rls, took = np.median(plain, axis=0)
    cells = []
    for method in METHODS:
        own, own_took = np.median([error(name, one, method) for one in logs], axis=0)
        least = min(rls, tried[best])
        cells.append(f"{100 * own:.2g} % | {own / least:.2f} | {own / rls:.2f} | "
                     f"{own_took / took:.1f}")  # fmt: skip
    return (f"| {name} | {condition} | {100 * rls:.2g} % | {100 * tried[best]:.2g} % "
            f"({MEMORIES[best]:g} s) | {' | '.join(cells)} |")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1000, help="of the first log")
    parser.add_argument("--robots", default="scara2,planar2-gravity,emps")
    given = parser.parse_args()
    print("| robot | condition | no forgetting | best factor (its memory) | adaptive | / best "
          "| / none | time |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|")
    for name in given.robots.split(","):
        for condition in CONDITIONS:
            seeds = range(given.seed, given.seed + given.seeds)
            print(row(name, condition, seeds), flush=True)


if __name__ == "__main__":
    main()
