"""Fifth-order polynomials between random via points, one joint at a time (paper section 3.1).

While a joint moves the others stand still: the test movements of the paper. All joints are at rest
at every via point. The limits on position, velocity and acceleration hold by construction.

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
        turn = np.arange(segments)[:, None] % joints
        mask: Array = turn == np.arange(joints)
        return mask

    def fewest(self, joints: int) -> int:
        return 2 * joints
