"""The checks that cost next to nothing, which `identify` makes by itself; see also stages.reach."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

import numpy as np

from scarid_cli.algorithms.checks import clock, leaps, units, values, velocities
from scarid_cli.algorithms.checks.finding import FAILED, OK, WARNING, Finding
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData
from scarid_cli.io.table import Table
from scarid_cli.stages.logs import log_of


def of_extremes(q: Array, tau: Array, robot: Robot, period: float) -> list[Finding]:
    """What is not in order in the extremes of positions and torques (joints, 2).

    The rows follow each other every `period` [s]. Only stated limits make a failure of positions
    that are far: a joint without limits may turn many times. A low rate may be that of the log.
    """
    log = Log(np.zeros(2), q, tau)
    positions, _ = units.positions(log, robot, np.zeros(len(q)))
    if not all(isfinite(joint.lower) and isfinite(joint.upper) for joint in robot.joints):
        positions = _as_warning(positions)
    found = [positions, units.torques(log, robot)]
    if rate := of_rate(period):
        found.append(_as_warning(rate))
    return [finding for finding in found if finding.status != OK]


def _as_warning(finding: Finding) -> Finding:
    return replace(finding, status=WARNING) if finding.status == FAILED else finding


def of_rate(period: float) -> Finding | None:
    """What is not in order in a clock with this period [s], if anything."""
    finding, _ = clock.unit(clock.Clock(np.array([period]), period))
    return finding if finding.status != OK else None


@contextlib.contextmanager
def in_seconds(log: Table) -> Iterator[None]:
    """A log that cannot be used because its time is not in seconds is refused for this reason."""
    try:
        yield
    except BadData:
        if finding := of_rate(log.period):
            raise BadData(f"{log.name}: {finding.text}") from None
        raise


def of_measurement(table: Table, robot: Robot) -> list[Finding]:
    """What is not in order in the values of a measurement in memory."""
    log = log_of(table, len(robot.joints))
    found = [clock.held(log), values.saturation(log.tau)]
    if log.dq is not None:
        found.append(velocities.finding(velocities.relation(log, table.period), table.period))
    if leapt := leaps.found_in(log):
        found += [leaps.wraps(leapt), leaps.glitches(leapt, log.resampling("--missing", "drop"))]
    return [finding for finding in found if finding.status != OK]
