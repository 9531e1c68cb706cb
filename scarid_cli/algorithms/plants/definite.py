"""Whether the mass matrix of a robot is one that a robot can have, in every posture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.plants.model import inertia, model
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

POSTURES = 1000
ROUNDING = 1e-12  # of the largest eigenvalue, below which a negative one is 0


@dataclass(frozen=True)
class Indefinite:
    """A mass matrix that no robot has.

    Its `least` eigenvalue, in the units of the axes, at `q` (joints) [rad or m], and the number of
    random postures in which one is negative.
    """

    least: float
    q: Array
    number: int

    @property
    def text(self) -> str:
        """What is wrong, and what to do."""
        place = ", ".join(f"{x:.3g}" for x in self.q)
        return (
            f"the mass matrix is not positive definite in {self.number} of {POSTURES} random "
            f"postures (least eigenvalue {self.least:.2g} at q = {place}), which is impossible; "
            "identify with --consistent"
        )


def random_postures(robot: Robot, count: int) -> Array:
    """Positions (count, joints) within the limits of the joints, or half a turn from 0."""
    limits = Limits.of(robot.joints)
    lower = np.where(np.isfinite(limits.lower), limits.lower, -np.pi)
    upper = np.where(np.isfinite(limits.upper), limits.upper, np.pi)
    return np.random.default_rng(0).uniform(lower, upper, (count, len(lower)))


def indefinite(robot: Robot) -> Indefinite | None:
    """Where the mass matrix of the a priori values is not positive definite; None if nowhere."""
    arm, places = model(robot), random_postures(robot, POSTURES)
    values = np.linalg.eigvalsh([inertia(arm, q) for q in places])
    negative = values[:, 0] < -ROUNDING * np.abs(values).max()
    if not negative.any():
        return None
    worst = int(np.argmin(values[:, 0]))
    return Indefinite(float(values[worst, 0]), places[worst], int(np.count_nonzero(negative)))
