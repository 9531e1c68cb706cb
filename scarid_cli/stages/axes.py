"""Joints whose axes point the other way than in the description, as `identify` finds them."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text
from scarid_cli.algorithms.checks.model import Samples, enough
from scarid_cli.algorithms.checks.wiring import reversed_axes
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot

FEWEST = 100  # rows of each joint with which another direction of an axis is tried


def of_axes(rows: Rows, robot: Robot) -> list[Finding]:
    """Joints whose positions and torques are both reversed, which hardly increases a residual."""
    if rows.samples < FEWEST or not np.all(np.count_nonzero(rows.scales, axis=0) >= FEWEST):
        return []
    joints = reversed_axes(robot, Samples.of_rows(rows, enough(robot)))
    if not joints:
        return []
    names = joints_text(joints)
    figure = f"the model fits far better with the position and the torque of {names} reversed"
    return [failed("axes", figure, "does the axis point the other way than in the description?")]
