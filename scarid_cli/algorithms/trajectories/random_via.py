"""Random via points, within limits by construction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.via import ViaPath, reach
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


@dataclass(frozen=True)
class RandomVia:
    """An excitation through random via points; a subclass says which joints move when."""

    shortest: float = 0.8
    longest: float = 2.0

    def moving(self, segments: int, joints: int) -> Array:
        """Which joints move in which segment: a mask (segments, joints)."""
        raise NotImplementedError

    def fewest(self, joints: int) -> int:
        """The number of segments that brings every joint away from home and back."""
        raise NotImplementedError

    def trajectory(
        self, limits: Limits, home: Array, duration: float, rng: np.random.Generator
    ) -> ViaPath:
        """A random motion of this duration [s] from home (joints) back to home."""
        segment = (self.shortest, self.longest)
        times = random_times(duration, segment, rng, at_least=self.fewest(len(home)))
        return random_path(limits, home, times, self.moving(len(times) - 1, len(home)), rng)


def random_path(
    limits: Limits, home: Array, times: Array, moving: Array, rng: np.random.Generator
) -> ViaPath:
    """Via points at the times [s] (points), from home (joints) back to home.

    `moving` (segments, joints) says which joints move in which segment.
    """
    far = np.array([reach(limits, T) for T in np.diff(times)]) * moving
    # The furthest that a joint may be from home and still come back in the segments left.
    tail = np.cumsum(far[::-1], axis=0)[::-1]
    back = np.vstack((tail[1:], np.zeros(len(home))))
    away = np.zeros((len(times), len(home)))  # from home
    for k in range(1, len(times)):
        room = back[k - 1]
        low = np.maximum(away[k - 1] - far[k - 1], np.maximum(limits.lower - home, -room))
        high = np.minimum(away[k - 1] + far[k - 1], np.minimum(limits.upper - home, room))
        high = np.maximum(low, high)  # equal but for rounding where the way back is the shortest
        away[k] = np.where(moving[k - 1], rng.uniform(low, high), away[k - 1])
    return ViaPath(times, np.clip(home + away, limits.lower, limits.upper))


def random_times(
    duration: float, segment: tuple[float, float], rng: np.random.Generator, at_least: int
) -> Array:
    """Times [s] from 0 to the duration, so many or more segments of random length apart."""
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
