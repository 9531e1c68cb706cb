"""How a log is unlike what the description of its robot says, by what explains its torques."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.changes.wiring import Wiring
from scarid_cli.algorithms.checks import fit, gearing, mounting, scale, wiring
from scarid_cli.algorithms.checks.finding import Finding
from scarid_cli.algorithms.checks.gearing import Gearing
from scarid_cli.algorithms.checks.model import Samples
from scarid_cli.algorithms.checks.motion import Motion
from scarid_cli.algorithms.checks.scale import Scale
from scarid_cli.algorithms.checks.search import Explained
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Unlike:
    """What differs, and the log without it.

    `findings` tell the mounting, `gears` are None if there are none, and `wired` has the wiring
    with which the `motion` fits the `robot`.
    """

    robot: Robot
    motion: Motion
    wired: Explained[Wiring]
    findings: tuple[Finding, ...] = ()
    gears: Gearing | None = None

    @property
    def geared(self) -> bool:
        """Whether positions are multiplied by factors."""
        return self.gears is not None and not self.gears.unscaled

    def scaled(self, factors: Array) -> Unlike:
        """The same for positions that were multiplied by these factors (joints) before."""
        if self.gears is None:
            return self
        scales = tuple((factors * self.gears.scales).tolist())
        return replace(self, gears=replace(self.gears, scales=scales))

    def motors(self, size: Scale) -> list[int]:
        """The joints (from 0) whose signals are those of motors, by the size of their torques."""
        return gearing.motors(self.gears, size) if self.gears else []

    def told(self, of_motors: list[int]) -> list[Finding]:
        """The findings on the mounting, or on the gearing."""
        return gearing.findings(self.gears, of_motors) if self.gears else [*self.findings]


def unlike(robot: Robot, motion: Motion, *, suspected: bool = False) -> Unlike | None:
    """What differs by the motion of a log; None if too few of its rows can be fitted.

    Its positions may be `suspected` of another unit, because of the limits of the robot.

    Axes, zeros and gravity are preferred where they explain the torques as well as other signs and
    orders; a clock, gears and couplings where they explain them far better than all of these.
    """
    samples = fit.samples_of(robot, motion)
    if samples is None or not samples.counts.any(axis=1).all():
        return None
    found = _mounted(robot, motion, samples)
    if found.wired.fit.residuals.max() <= gearing.LEFT:
        return found
    gears = gearing.geared(robot, samples, suspected=suspected)
    if not gearing.better(gears, found.wired.fit, robot, samples):
        return found
    same = Explained(Wiring.same(len(robot.joints)), gears.fit)
    return Unlike(robot, gears.case.motion(motion), same, gears=gears.case)


def _mounted(robot: Robot, motion: Motion, samples: Samples) -> Unlike:
    found, fitting = wiring.wired(robot, samples), mounting.mounted(robot, samples)
    left = scale.disagreement(robot, samples.wired(found.case))
    mounted = mounting.by_masses(robot, samples, fitting, left)
    by_masses = mounted is not fitting
    what = "the described masses fit" if by_masses else "the model fits"
    differs = mounting.findings(mounted.case, what)
    most = found.fit.misfit + (mounting.alike(robot) if by_masses else 0.0)
    if not differs or mounted.fit.misfit >= most:
        return Unlike(robot, motion, found)
    turned = motion.mounted(np.array(mounted.case.signs), np.array(mounted.case.turns))
    same = Explained(Wiring.same(len(robot.joints)), mounted.fit)
    return Unlike(mounted.case.of(robot), turned, same, tuple(differs))
