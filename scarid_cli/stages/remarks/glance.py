"""The checks that cost next to nothing, which `identify` makes by itself; see also stages.reach."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import replace
from math import isfinite

import numpy as np

from scarid_cli.algorithms.checks import clock, jumps, leaps, units, values, velocities
from scarid_cli.algorithms.checks.finding import FAILED, OK, WARNING, Finding
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, spread_starts
from scarid_cli.errors import BadData
from scarid_cli.io.table import Table
from scarid_cli.stages.records.compact import Compact
from scarid_cli.stages.records.holding import measured
from scarid_cli.stages.records.logs import velocities_of

BLOCKS, ROWS = 10, 20_000  # of a long log


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


@contextlib.contextmanager
def explained(name: str, findings: Callable[[], list[Finding]]) -> Iterator[None]:
    """A log that cannot be used is refused for what is not in order with it, if anything is."""
    try:
        yield
    except BadData as error:
        found = [finding for finding in findings() if finding.status == FAILED]
        if not found:
            raise
        parts = [one.text for one in found]
        why = str(error).removeprefix(f"{name}: ").partition(";")[0]
        more = "`scarid check` looks for more"
        raise BadData(f"{name}: {'; '.join(parts)}; {more} ({why})") from None


def of_measurement(held: Compact) -> list[Finding]:
    """What is not in order in the values of a measurement in memory.

    What concerns all of a long log is seen in blocks that are spread over it.
    """
    log = _log(held)
    some = _spread(log)
    found = [clock.held(some), values.copied(log.q), values.saturation(log.tau)]
    if log.dq is not None:
        period = held.source.period
        found.append(velocities.finding(velocities.relation(some, period), period))
    leapt = leaps.found_in(log)
    jumped = jumps.told(jumps.jumped(leaps.mended(log, leapt)), log.joints, log.rows)
    if leapt or jumped:
        resampling = log.resampling("--missing", "drop")
        found += [leaps.wraps(leapt), leaps.glitches(leapt, jumped, resampling)]
    return [finding for finding in found if finding.status != OK]


def _log(held: Compact) -> Log:
    """The log of a measurement in memory, of which it has views."""
    joints = held.joints
    t, q, tau = held.values[0], held.values[1 : joints + 1], held.values[joints + 1 :]
    others = [x for x in measured(held.source.schema) if x not in held.names]
    dq = velocities_of(held.source, joints)
    return Log(t, q, tau, held.other(others) if others else None, held.other(dq) if dq else None)


def _spread(log: Log) -> Log:
    """Blocks that are spread over a long log, or all of another."""
    if log.rows <= 2 * BLOCKS * ROWS:
        return log
    starts = spread_starts(log.rows, ROWS, BLOCKS)
    return log.part((starts[:, None] + np.arange(ROWS)).ravel())
