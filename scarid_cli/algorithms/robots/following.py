"""Joints that follow an axis: q_joint = ratio q_axis + offset, the <mimic> of a URDF.

What a following joint takes, its axis has to give: its torque times the ratio (virtual work).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.arrays import Array, Numbers


@dataclass(frozen=True)
class Following:
    """How the joints of a chain, from the base to the tip, move with its axes.

    `axis` (joints): the axis of each joint, from 0; `ratio` (joints) and `offset` (joints) [rad or
    m]; `own` (axes): the joint that is the axis itself.
    """

    axis: Numbers
    ratio: Array
    offset: Array
    own: Numbers

    @classmethod
    def none(cls, axes: int) -> Following:
        """All joints are axes."""
        return cls(np.arange(axes), np.ones(axes), np.zeros(axes), np.arange(axes))

    @cached_property
    def followers(self) -> list[int]:
        """The joints that are no axes."""
        return [k for k in range(len(self.axis)) if k not in self.own]

    def limited(self, joints: Sequence[Joint]) -> list[Joint]:
        """The axes, so limited that the joints which follow them keep their own limits."""
        limited = [joints[k] for k in self.own]
        for k in self.followers:
            axis, ratio, offset = self.axis[k], float(self.ratio[k]), float(self.offset[k])
            if ratio:
                limited[axis] = _within(limited[axis], joints[k], ratio, offset)
        return limited

    def positions(self, q: Array) -> Array:
        """Those of the joints, from those of the axes (axes, samples)."""
        return self.rates(q) + self.offset[:, None] if self.followers else q

    def rates(self, dq: Array) -> Array:
        """Velocities or accelerations of the joints, from those of the axes (axes, ...)."""
        if not self.followers:
            return dq
        return np.asarray(self.ratio.reshape(-1, *(1,) * (dq.ndim - 1)) * dq[self.axis])

    def torques(self, W: Array) -> Array:
        """Torques of the axes, from those of the joints in the rows of W (joints, ...)."""
        if not self.followers:
            return W
        found = np.zeros((len(self.own), *W.shape[1:]))
        for axis, ratio, own in zip(self.axis, self.ratio, W, strict=True):
            found[axis] += ratio * own
        return found


def _within(axis: Joint, follower: Joint, ratio: float, offset: float) -> Joint:
    """The axis within the limits that a joint has which follows it; torques are not its own."""
    ends = sorted((end - offset) / ratio for end in (follower.lower, follower.upper))
    return replace(
        axis,
        lower=max(axis.lower, ends[0]),
        upper=min(axis.upper, ends[1]),
        velocity_limit=min(axis.velocity_limit, follower.velocity_limit / abs(ratio)),
    )
