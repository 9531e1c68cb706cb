"""The recommended way from a measurement to a motion, with nothing to choose."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.lowpassed import TWO_SIDED
from scarid_cli.errors import TooShort
from scarid_cli.io.table import Table
from scarid_cli.stages.bandwidth import Bandwidth, bandwidth, recommended, smoother_at
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
    held, log = _in_memory(measurement, robot)
    found = bandwidth(held, robot, progress)
    smoother = recommended(found, measurement.period)
    return matched(log, [smoother] * held.joints, left_out), found, smoother


def motion_passing(
    measurement: Table, robot: Robot, hertz: float, left_out: list[TooShort]
) -> tuple[Table, Any]:
    """The motion of a measurement, behind the smoother that passes half the power at hertz [Hz].

    Also the smoother. The measurement is held in memory. `left_out` is as for `motion_of`.
    """
    held, log = _in_memory(measurement, robot)
    smoother = smoother_at(held, hertz / TWO_SIDED)
    return matched(log, [smoother] * held.joints, left_out), smoother


def _in_memory(measurement: Table, robot: Robot) -> tuple[Record, Table]:
    """The positions and torques of a measurement, and the measurement once more."""
    batches = list(measurement.batches)
    first, again = (replace(measurement, batches=iter(batches)) for _ in range(2))
    return Record.of(first, len(robot.joints), torques=True), again
