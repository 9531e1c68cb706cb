"""Fifth-order polynomials between random via points, all joints together (paper eq. 28).

The joints are at rest at every via point. The limits on position, velocity and acceleration hold by
construction.

shortest = 0.8 [s], longest = 2 [s]: range of the time from one via point to the next.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.random_via import random_path, random_times
from scarid_cli.algorithms.trajectories.via import ViaPath
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Excitation:
    shortest: float = 0.8
    longest: float = 2.0

    def trajectory(
        self, limits: Limits, home: Array, duration: float, rng: np.random.Generator
    ) -> ViaPath:
        """A random motion of this duration [s] from home (joints) back to home."""
        times = random_times(duration, (self.shortest, self.longest), rng, at_least=2)
        moving = np.ones((len(times) - 1, len(home)), dtype=bool)
        return random_path(limits, home, times, moving, rng)
