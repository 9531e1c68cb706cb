"""Fifth-order polynomials between via points, at rest at each of them (paper eq. 28).

In a segment of a distance D and a time T the largest velocity is 15/8 D/T and the largest
acceleration 10/sqrt(3) D/T^2. The position is monotone, so that the whole motion lies within its
position limits if the via points do.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from scarid_cli.algorithms.trajectories.limits import TOLERANCE, Limits
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

PEAK_VELOCITY = 15.0 / 8.0
PEAK_ACCELERATION = 10.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class ViaPath:
    """Via points: times (points) from 0 [s], positions (points, joints) [rad or m]."""

    times: Array
    points: Array

    @property
    def duration(self) -> float:
        return float(self.times[-1])

    @property
    def summary(self) -> str:
        return f"{len(self.times) - 1} segments"

    def sample(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations, each (joints, samples), at the times t [s]."""
        segment = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        start = self.points[segment].T
        distance = self.points[segment + 1].T - start
        T = self.times[segment + 1] - self.times[segment]
        u = np.clip((t - self.times[segment]) / T, 0.0, 1.0)
        q = start + distance * (u**3 * (10.0 + u * (6.0 * u - 15.0)))
        dq = distance / T * (30.0 * u * u * (1.0 - u) ** 2)
        ddq = distance / T**2 * (60.0 * u * (1.0 - u) * (1.0 - 2.0 * u))
        return q + 0.0, dq + 0.0, ddq + 0.0  # no negative zeros in the table


def reach(limits: Limits, duration: float) -> Array:
    """How far each joint may go in one segment of this duration [s] (joints)."""
    by_velocity = limits.dq * duration / PEAK_VELOCITY
    by_acceleration = limits.ddq * duration**2 / PEAK_ACCELERATION
    far: Array = np.minimum(by_velocity, by_acceleration)
    return far


def through(path: ViaPath, limits: Limits, home: Array) -> ViaPath:
    """The path itself, if it starts and ends at home (joints) and keeps the limits (eq. 28)."""
    if len(path.times) < 2 or np.any(np.diff(path.times) <= 0.0):
        raise UsageFault("give two via points or more, with times that increase")
    _require_home(path, home)
    for k, position in enumerate(path.points):
        for (joint,) in limits.outside(position):
            raise UsageFault(
                f"via point {k + 1}: joint {joint + 1} at {position[joint]:g} is outside its "
                f"position limits, {limits.interval(joint)}"
            )
    for k, T in enumerate(np.diff(path.times)):
        distance = np.abs(path.points[k + 1] - path.points[k])
        for far in np.flatnonzero(distance > reach(limits, T) * (1.0 + TOLERANCE)):
            raise UsageFault(_too_fast(k, T, int(far), distance[far], limits))
    return path


def _require_home(path: ViaPath, home: Array) -> None:
    size = TOLERANCE * np.maximum(1.0, np.abs(home))
    start = ",".join(f"{x:.10g}" for x in path.points[0])
    for point, where, remedy in (
        (path.points[0], "start", f"give --home {start} or change the via points"),
        (path.points[-1], "end", "change the last via point"),
    ):
        for joint in np.flatnonzero(np.abs(point - home) > size):
            raise UsageFault(
                f"the via points must {where} at the home position: joint {joint + 1} is at "
                f"{point[joint]:g} and its home at {home[joint]:g}; {remedy}"
            )


def _too_fast(k: int, T: float, joint: int, distance: float, limits: Limits) -> str:
    needed = max(
        PEAK_VELOCITY * distance / limits.dq[joint],
        np.sqrt(PEAK_ACCELERATION * distance / limits.ddq[joint]),
    )
    return (
        f"segment {k + 1}: joint {joint + 1} would reach velocity "
        f"{PEAK_VELOCITY * distance / T:.4g} and acceleration "
        f"{PEAK_ACCELERATION * distance / T**2:.4g}, its bounds are {limits.dq[joint]:g} and "
        f"{limits.ddq[joint]:g}; give the segment at least {ceil(needed * 1e4) / 1e4} s "
        f"instead of {T:.4g} s"
    )
