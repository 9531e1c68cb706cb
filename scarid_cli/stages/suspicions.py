"""What is not in order with a log beside the model of its robot, as `identify` finds it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.checks import units
from scarid_cli.algorithms.checks.finding import FAILED, WARNING, Finding, failed, joints_text
from scarid_cli.algorithms.checks.fit import ratios
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.checks.model import Samples, enough
from scarid_cli.algorithms.checks.wiring import reversed_axes
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot

FEWEST = 100  # rows of each joint with which another direction of an axis is tried


def of_model(rows: Rows, robot: Robot) -> list[Finding]:
    """Axes that point the other way than in the description, and torques in another unit."""
    if rows.samples < FEWEST or not np.all(np.count_nonzero(rows.scales, axis=0) >= FEWEST):
        return []
    samples = Samples.of_rows(rows, enough(robot))
    return [*_axes(samples, robot), *_torques(samples, robot)]


def _axes(samples: Samples, robot: Robot) -> list[Finding]:
    """Joints whose positions and torques are both reversed, which hardly increases a residual."""
    joints = reversed_axes(robot, samples)
    if not joints:
        return []
    names = joints_text(joints)
    figure = f"the model fits far better with the position and the torque of {names} reversed"
    return [failed("axes", figure, "does the axis point the other way than in the description?")]


def _torques(samples: Samples, robot: Robot) -> list[Finding]:
    """A warning only: a priori parameters may be those of the robot whose file was copied."""
    q, dq, ddq, tau, _ = samples.motion
    found = units.torques(
        Log(np.zeros(tau.shape[1]), q, tau),
        robot,
        ratios(robot, robot.regressor(q, dq, ddq), samples),
    )
    return [replace(found, status=WARNING)] if found.status == FAILED else []
