"""Constraints on where the links are: the tool inside a box, and links apart from one another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.design.model import Motion
from scarid_cli.algorithms.robots.clearance import Clearance, inside
from scarid_cli.algorithms.robots.pose import Points
from scarid_cli.algorithms.robots.rigid import Body
from scarid_cli.arrays import Array

LENGTH = 0.2  # m: violations are relative to it
WALLS = ("x", "y", "z")


@dataclass(frozen=True)
class Workspace:
    """A box, from its corner `lower` to `upper` (3) [m], that the tool must not leave."""

    body: Body
    tool: Points
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    @classmethod
    def of(cls, body: Body, box: Sequence[float]) -> Workspace:
        """The box of three intervals, x, y and z, in the frame of the base."""
        frame = body.frames[body.tool]
        tool = Points(np.array([frame.axis]), frame.carried((0.0, 0.0, 0.0)).reshape(1, 3))
        return cls(body, tool, tuple(box[::2]), tuple(box[1::2]))

    @property
    def names(self) -> list[str]:
        return [f"{end} {wall} of the workspace" for end in ("lower", "upper") for wall in WALLS]

    @property
    def exact(self) -> Workspace:
        return self

    def violations(self, motion: Motion) -> Array:
        found, _ = inside(self.tool, self.body.pose(motion[0]), self.lower, self.upper)
        return -found[:, 0] / LENGTH

    def slopes(self, motion: Motion, multipliers: Array) -> Motion:
        _, pull = inside(self.tool, self.body.pose(motion[0]), self.lower, self.upper)
        return _of_positions(self.body, pull(-multipliers[:, None] / LENGTH))


@dataclass(frozen=True)
class Apart:
    """Links that must not touch."""

    body: Body
    clearance: Clearance

    @classmethod
    def of(cls, body: Body, home: Array) -> Apart:
        """All pairs of links but those whose capsules overlap at home (joints) already."""
        clearance = Clearance.of(body)
        if not len(clearance.pairs):
            return cls(body, clearance)
        distances, _ = clearance.distances(body.pose(home[:, None]))
        free = np.flatnonzero(distances[:, 0] > 0.0)
        names = tuple(clearance.names[i] for i in free)
        return cls(body, replace(clearance, pairs=clearance.pairs[free], names=names))

    @property
    def names(self) -> list[str]:
        return [f"distance of {pair}" for pair in self.clearance.names]

    @property
    def exact(self) -> Apart:
        return self

    def violations(self, motion: Motion) -> Array:
        distances, _ = self.clearance.distances(self.body.pose(motion[0]))
        return -distances / LENGTH

    def slopes(self, motion: Motion, multipliers: Array) -> Motion:
        _, pull = self.clearance.distances(self.body.pose(motion[0]))
        return _of_positions(self.body, pull(-multipliers / LENGTH))


def _of_positions(body: Body, slopes: Array) -> Motion:
    slopes = body.following.torques(slopes)
    return slopes, np.zeros_like(slopes), np.zeros_like(slopes)
