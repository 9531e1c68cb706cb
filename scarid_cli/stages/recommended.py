"""The recommended way from a measurement to a motion, with nothing to choose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.errors import TooShort
from scarid_cli.io.table import Table
from scarid_cli.stages.bandwidth import Bandwidth, bandwidth, recommended
from scarid_cli.stages.differentiate import matched
from scarid_cli.stages.record import Record


def motion_of(
    measurement: Table,
    robot: Robot,
    progress: Callable[[], object],
    left_out: list[TooShort],
) -> tuple[Table, Bandwidth, Any]:
    """The motion of a measurement, behind the smoother at which the parameters scatter least.

    Also the bandwidth and the smoother. The measurement is held in memory. `left_out` receives the
    reason for each segment that was left out.
    """
    batches = list(measurement.batches)
    joints = len(robot.joints)
    held = Record.of(replace(measurement, batches=iter(batches)), joints, torques=True)
    found = bandwidth(held, robot, progress)
    smoother = recommended(found, measurement.period)
    log = replace(measurement, batches=iter(batches))
    return matched(log, [smoother] * joints, left_out), found, smoother
