"""Fifth-order polynomials between random via points, one joint at a time (paper section 3.1).

While a joint moves the others stand still: the test movements of the paper. All joints are at rest
at every via point. The limits on position, velocity and acceleration hold by construction.

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
        joints = len(home)
        # Each joint moves away and back, at least.
        times = random_times(duration, (self.shortest, self.longest), rng, at_least=2 * joints)
        moving = np.arange(len(times) - 1)[:, None] % joints == np.arange(joints)
        return random_path(limits, home, times, moving, rng)
