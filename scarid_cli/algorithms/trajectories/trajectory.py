"""The interface of trajectories, whatever curve they follow."""

from __future__ import annotations

from typing import Protocol

from scarid_cli.arrays import Array


class Trajectory(Protocol):
    """A motion of all joints from time 0 to `duration` [s]."""

    @property
    def duration(self) -> float: ...

    @property
    def summary(self) -> str:
        """How it is made up, in a few words for the user: `15 segments`."""
        ...

    def sample(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations, each (joints, samples), at the times t [s]."""
        ...
