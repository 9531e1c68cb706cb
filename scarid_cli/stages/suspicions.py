"""What is not in order with a log beside the model of its robot, as `identify` finds it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.checks import mounting, units
from scarid_cli.algorithms.checks.finding import FAILED, WARNING, Finding
from scarid_cli.algorithms.checks.fit import ratios
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.checks.model import Samples, enough
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot

FEWEST = 100  # rows of each joint with which the description is put to the test


def of_model(rows: Rows, robot: Robot) -> list[Finding]:
    """Axes, zeros and gravity unlike in the description, and torques in another unit."""
    if rows.samples < FEWEST or not np.all(np.count_nonzero(rows.scales, axis=0) >= FEWEST):
        return []
    samples = Samples.of_rows(rows, enough(robot))
    return [*mounting.findings(mounting.mounted(robot, samples).case), *_torques(samples, robot)]


def _torques(samples: Samples, robot: Robot) -> list[Finding]:
    """A warning only: a priori parameters may be those of the robot whose file was copied."""
    q, dq, ddq, tau, _ = samples.motion
    found = units.torques(
        Log(np.zeros(tau.shape[1]), q, tau),
        robot,
        ratios(robot, robot.regressor(q, dq, ddq), samples),
    )
    return [replace(found, status=WARNING)] if found.status == FAILED else []
