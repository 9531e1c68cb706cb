"""Fifth-order polynomials between random via points, all joints together (paper eq. 28).

The joints are at rest at every via point. The limits on position, velocity and acceleration hold by
construction.

shortest = 0.8 [s], longest = 2 [s]: range of the time from one via point to the next.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.trajectories.random_via import RandomVia
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Excitation(RandomVia):
    def moving(self, segments: int, joints: int) -> Array:
        return np.ones((segments, joints), dtype=bool)

    def fewest(self, joints: int) -> int:  # noqa: ARG002
        return 2
