"""Excitation by fifth-order polynomials between via points (paper eq. 28).

Every segment starts and ends at rest, so its largest velocity and acceleration are known in
closed form: 15/8 D/T and 10/sqrt(3) D/T^2 for a distance D in a time T.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

PEAK_VELOCITY = 15.0 / 8.0
PEAK_ACCELERATION = 10.0 / np.sqrt(3.0)


@dataclass(frozen=True)
class Bounds:
    """Limits on |q|, |dq| and |ddq|, one number per joint, in the joints' units."""

    q: Array
    dq: Array
    ddq: Array

    def reach(self, duration: float) -> Array:
        """How far each joint may go in one segment of this duration [s]."""
        by_velocity = self.dq * duration / PEAK_VELOCITY
        by_acceleration = self.ddq * duration**2 / PEAK_ACCELERATION
        reach: Array = np.minimum(by_velocity, by_acceleration)
        return reach


@dataclass(frozen=True)
class Path:
    """Via points: times (points) from 0 [s], positions (points, joints)."""

    times: Array
    points: Array

    @property
    def duration(self) -> float:
        return float(self.times[-1])

    def sample(self, t: Array) -> tuple[Array, Array, Array]:
        """Positions, velocities and accelerations (joints, samples) at the times t."""
        segment = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2)
        start = self.points[segment].T
        distance = self.points[segment + 1].T - start
        T = self.times[segment + 1] - self.times[segment]
        u = np.clip((t - self.times[segment]) / T, 0.0, 1.0)
        q = start + distance * (u**3 * (10.0 + u * (6.0 * u - 15.0)))
        dq = distance / T * (30.0 * u * u * (1.0 - u) ** 2)
        ddq = distance / T**2 * (60.0 * u * (1.0 - u) * (1.0 - 2.0 * u))
        return q + 0.0, dq + 0.0, ddq + 0.0  # no negative zeros in the table


def random_path(
    bounds: Bounds,
    duration: float,
    segment: tuple[float, float],
    rng: np.random.Generator,
    *,
    sequential: bool = False,
) -> Path:
    """Random via points, from zero back to zero, within the bounds by construction.

    Segments last from `segment[0]` to `segment[1]` [s]. With `sequential` the joints move one
    after the other while the rest is locked (the paper's test movements); else all together.
    """
    joints = len(bounds.q)
    times = _times(duration, segment, rng, at_least=2 * joints if sequential else 2)
    moving = np.ones((len(times) - 1, joints), dtype=bool)
    if sequential:
        moving = np.arange(len(times) - 1)[:, None] % joints == np.arange(joints)
    reach = np.array([bounds.reach(T) for T in np.diff(times)]) * moving
    # The furthest that a joint may be from zero and still come back in the segments left.
    tail = np.cumsum(reach[::-1], axis=0)[::-1]
    back = np.minimum(np.vstack((tail[1:], np.zeros(joints))), bounds.q)
    points = np.zeros((len(times), joints))
    for k in range(1, len(times)):
        low = np.maximum(points[k - 1] - reach[k - 1], -back[k - 1])
        high = np.minimum(points[k - 1] + reach[k - 1], back[k - 1])
        high = np.maximum(low, high)  # equal but for rounding where the way back is the shortest
        points[k] = np.where(moving[k - 1], rng.uniform(low, high), points[k - 1])
    return Path(times, points)


def _times(
    duration: float, segment: tuple[float, float], rng: np.random.Generator, at_least: int
) -> Array:
    shortest, longest = segment
    if not 0.0 < shortest <= longest:
        raise UsageFault(f"segments of {shortest:g} to {longest:g} s: give 0 < shortest <= longest")
    if duration < at_least * shortest:
        raise UsageFault(
            f"a duration of {duration:g} s is too short for {at_least} segments of at least "
            f"{shortest:g} s; lengthen it or shorten the segments"
        )
    lengths: list[float] = []
    total = 0.0
    while total < duration:
        lengths.append(rng.uniform(shortest, longest))
        total += lengths[-1]
    # Stretch or shrink all a little, so that they end on time and stay within their limits.
    count = max(len(lengths), at_least)
    if duration / count < shortest:
        count -= 1
    lengths = (lengths + [shortest] * at_least)[:count]
    fitted = _fit(np.array(lengths), duration, shortest, longest)
    times = np.concatenate(([0.0], np.cumsum(fitted)))
    times[-1] = duration
    return times


def _fit(lengths: Array, total: float, shortest: float, longest: float) -> Array:
    """Move lengths towards one of their limits, each in proportion, until they have the sum."""
    missing = total - lengths.sum()
    room = longest - lengths if missing > 0.0 else lengths - shortest
    if room.sum() <= 0.0:
        return np.full(len(lengths), total / len(lengths))
    fitted: Array = lengths + missing * room / room.sum()
    return fitted


def through(path: Path, bounds: Bounds, tolerance: float = 1e-9) -> Path:
    """The path itself, if it is at zero at both ends and within the bounds (eq. 28)."""
    slack = 1.0 + tolerance
    if len(path.times) < 2 or np.any(np.diff(path.times) <= 0.0):
        raise UsageFault("give two via points or more, with times that increase")
    for end, where in ((0, "begin"), (-1, "end")):
        if np.any(np.abs(path.points[end]) > tolerance):
            raise UsageFault(f"the via points must {where} at zero in every joint (eq. 28)")
    for k, position in enumerate(path.points):
        for joint in np.flatnonzero(np.abs(position) > bounds.q * slack):
            raise UsageFault(
                f"via point {k + 1}: joint {joint + 1} at {position[joint]:g} is beyond its "
                f"position bound of {bounds.q[joint]:g}"
            )
    for k, T in enumerate(np.diff(path.times)):
        distance = np.abs(path.points[k + 1] - path.points[k])
        for joint in np.flatnonzero(distance > bounds.reach(T) * slack):
            raise UsageFault(_too_fast(k, T, int(joint), distance[joint], bounds))
    return path


def _too_fast(k: int, T: float, joint: int, distance: float, bounds: Bounds) -> str:
    needed = max(
        PEAK_VELOCITY * distance / bounds.dq[joint],
        np.sqrt(PEAK_ACCELERATION * distance / bounds.ddq[joint]),
    )
    return (
        f"segment {k + 1}: joint {joint + 1} would reach velocity "
        f"{PEAK_VELOCITY * distance / T:.4g} and acceleration "
        f"{PEAK_ACCELERATION * distance / T**2:.4g}, its bounds are {bounds.dq[joint]:g} and "
        f"{bounds.ddq[joint]:g}; give the segment at least {ceil(needed * 1e4) / 1e4} s "
        f"instead of {T:.4g} s"
    )
