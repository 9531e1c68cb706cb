"""Motions one after the other: an approach, and repeated periods."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.algorithms.trajectories.via import PEAK_ACCELERATION, PEAK_VELOCITY, ViaPath
from scarid_cli.arrays import Array

SLOW = 0.2  # of the limits of velocity and acceleration


@dataclass(frozen=True)
class Joined:
    """Motions that each start where the one before ends."""

    parts: tuple[Trajectory, ...]
    summary: str

    @property
    def duration(self) -> float:
        return sum(part.duration for part in self.parts)

    def sample(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations, each (joints, samples), at the times t [s]."""
        starts = np.cumsum([0.0, *(part.duration for part in self.parts[:-1])])
        turn = np.searchsorted(starts, t, side="right") - 1
        found = [
            part.sample(np.clip(t[turn == i] - starts[i], 0.0, part.duration))
            for i, part in enumerate(self.parts)
        ]
        q, dq, ddq = (np.concatenate(signals, axis=1) for signals in zip(*found, strict=True))
        return q, dq, ddq


def approach(start: Array, home: Array, limits: Limits, rate: float) -> ViaPath:
    """A slow motion from a posture to home (joints), whose time is a whole number of rows."""
    distance = np.abs(home - start)
    needed = np.maximum(
        PEAK_VELOCITY * distance / (SLOW * limits.dq),
        np.sqrt(PEAK_ACCELERATION * distance / (SLOW * limits.ddq)),
    )
    rows = max(1, ceil(float(needed.max()) * rate))
    return ViaPath(np.array([0.0, rows / rate]), np.array([start, home]))
