"""Distances between the links of a robot, as far as capsules describe them, and their gradients."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from scarid_cli.algorithms.robots.pose import Points, Pose, Pullback
from scarid_cli.algorithms.robots.rigid import Body
from scarid_cli.arrays import Array, Numbers

APART = 2  # links with fewer axes between them touch at their joint
POINT = 1e-12  # m2: square of the length of a segment that is a point
PARALLEL = 1e-9  # squared sine of the angle between segments that count as parallel
TOUCHING = 1e-9  # m: segments that meet have no direction from one to the other


@dataclass(frozen=True)
class Clearance:
    """The pairs of capsules that must not touch.

    `starts` and `ends` are the ends of the segments of all capsules, `radii` (capsules) [m];
    `pairs` (pairs, 2) are numbers of capsules, `names` (pairs) their links.
    """

    starts: Points
    ends: Points
    radii: Array
    pairs: Numbers
    names: tuple[str, ...]

    @classmethod
    def of(cls, body: Body) -> Clearance:
        """The pairs on links between which there are at least two axes."""
        capsules, frames = body.capsules, body.frames
        link = np.array([frames[c.link].axis for c in capsules], dtype=np.int64)
        pairs = [
            (i, j)
            for i, j in combinations(range(len(capsules)), 2)
            if abs(link[i] - link[j]) >= APART
        ]
        starts = [frames[c.link].carried(c.start) for c in capsules]
        ends = [frames[c.link].carried(c.end) for c in capsules]
        return cls(
            Points(link, np.array(starts).reshape(-1, 3)),
            Points(link, np.array(ends).reshape(-1, 3)),
            np.array([c.radius for c in capsules]),
            np.array(pairs, dtype=np.int64).reshape(-1, 2),
            tuple(f"{capsules[i].link} and {capsules[j].link}" for i, j in pairs),
        )

    def distances(self, pose: Pose) -> tuple[Array, Pullback]:
        """The signed distances (pairs, samples) [m], negative where capsules overlap; the pullback.

        The distance of two segments has a kink where they are parallel side by side. The derivative
        there is that at the middle of one of them.
        """
        (start, back_start), (end, back_end) = map(pose.positions, (self.starts, self.ends))
        one, two = self.pairs.T
        s, t = closest(start[one], end[one], start[two], end[two])
        s, t = s[..., None], t[..., None]
        apart = (1.0 - s) * start[one] + s * end[one] - (1.0 - t) * start[two] - t * end[two]
        length = np.linalg.norm(apart, axis=2)
        way = apart / np.maximum(length, TOUCHING)[..., None]

        def pullback(slopes: Array) -> Array:
            force = slopes[..., None] * way
            first, second = (
                (np.arange(len(start))[:, None] == own).astype(float) for own in (one, two)
            )
            starts = np.tensordot(first, (1.0 - s) * force, 1)
            ends = np.tensordot(first, s * force, 1)
            starts -= np.tensordot(second, (1.0 - t) * force, 1)
            ends -= np.tensordot(second, t * force, 1)
            return back_start(starts) + back_end(ends)

        return length - (self.radii[one] + self.radii[two])[:, None], pullback


def closest(p1: Array, q1: Array, p2: Array, q2: Array) -> tuple[Array, Array]:
    """Where the segments p1 q1 and p2 q2 (..., 3) are closest: the parts s and t of their lengths.

    Ericson, Real-Time Collision Detection, 2005, section 5.1.9.
    """
    d1, d2, r = q1 - p1, q2 - p2, p1 - p2
    a, b, e = _dot(d1, d1), _dot(d1, d2), _dot(d2, d2)
    c, f = _dot(d1, r), _dot(d2, r)
    determinant = a * e - b * b
    parallel = determinant <= np.maximum(PARALLEL * a * e, POINT * POINT)
    s = np.where(parallel, 0.5, (b * f - c * e) / np.where(parallel, 1.0, determinant))
    t = ((b * s.clip(0.0, 1.0) + f) / np.maximum(e, POINT)).clip(0.0, 1.0)
    s = ((b * t - c) / np.maximum(a, POINT)).clip(0.0, 1.0)
    return s, t


def _dot(x: Array, y: Array) -> Array:
    return np.asarray(np.einsum("...i,...i", x, y))


def inside(
    points: Points, pose: Pose, lower: Sequence[float], upper: Sequence[float]
) -> tuple[Array, Pullback]:
    """How far points are inside a box (6, points, samples) [m], and the pullback.

    The walls are the three at `lower` and the three at `upper` (3) [m], in the frame of the base;
    the distance is negative beyond a wall.
    """
    X, back = pose.positions(points)
    distances = np.concatenate((X - np.array(lower), np.array(upper) - X), axis=2)

    def pullback(slopes: Array) -> Array:
        return back(np.moveaxis(slopes[:3] - slopes[3:], 0, 2))

    return np.moveaxis(distances, 2, 0), pullback
