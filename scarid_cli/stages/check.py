"""The checks of a log, in the order in which a colleague would look at it.

What an earlier check explains is put right for the later ones, so that one cause gives one line: a
log in degrees is checked on in rad, one with exchanged joints in their order.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scarid_cli.algorithms.checks import (
    clock,
    fit,
    jumps,
    leaps,
    movement,
    scale,
    units,
    values,
    velocities,
    wiring,
)
from scarid_cli.algorithms.checks.finding import FAILED, OK, Finding, failed, ok, several
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.checks.motion import Motion
from scarid_cli.algorithms.checks.unlike import Unlike, unlike
from scarid_cli.algorithms.robots.description import Robot

FEWEST = 2  # rows: one has no rate


def check(log: Log, robot: Robot) -> Iterator[Finding]:
    """The findings on a log of this robot."""
    if log.rows < FEWEST:
        yield failed("length", several(log.rows, "row"), "give a longer log")
        return
    order, ticks = clock.order(log), clock.ticks(log)
    if ticks.coarse:
        yield clock.coarse(ticks)
        if not ticks.rate:
            return
        log = log.counted(ticks.rate)
        order = clock.order(log)
    log = log.in_order()
    finding, factor = clock.unit(clock.Clock.of(log.t, log.segment))
    yield finding
    yield order
    log = log.scaled(t=factor)
    lacking = values.missing(log)
    if log.in_turn:
        log = log.filled()
    time = clock.Clock.of(log.t, log.segment)
    yield from clock.clock(time, log.resampling())
    yield lacking
    found = leaps.found_in(log)
    yield leaps.wraps(found)
    resampling, mended = log.resampling("--missing", "drop"), leaps.mended(log, found)
    jumped = jumps.jumped(mended)
    yield leaps.glitches(found, jumps.told(jumped, log.joints, log.rows), resampling)
    log = jumps.without(mended, jumped)
    related = velocities.relation(log, time.period)
    if log.dq is not None:
        yield velocities.finding(related, time.period)
    yield clock.held(log)
    yield clock.slower(log)
    empty = [name for name, x in zip(log.names, log.signals, strict=True) if np.isnan(x).all()]
    if empty:
        yield failed("values", f"no value in {', '.join(empty)}", "log these columns")
        return
    copied = values.copied(log.q)
    yield copied
    driven = values.constant(log.tau)
    yield driven
    if driven.status == OK and time.period:
        driven = values.dead_zone(log, time.period)
        yield driven
    yield values.saturation(log.tau)
    motion = Motion.of(log, time.period) if time.period else None
    if motion is None or not motion.parts():
        figure = f"{log.rows} rows, too few without a gap for the checks of motion and model"
        yield failed("length", figure, "give a longer log")
        return
    whole = copied.status == driven.status == OK
    alike = velocities.in_step(related)
    yield from _moving(log, robot, motion, whole=whole, with_velocities=alike)


def _moving(
    log: Log, robot: Robot, motion: Motion, *, whole: bool, with_velocities: bool
) -> Iterator[Finding]:
    """The findings on the motion, and on the model if every joint has its own signals (`whole`).

    The velocities of the log are in the unit of its positions `with_velocities`.
    """
    parts = motion.parts()
    speeds = np.max([np.abs(part.motion[1]).max(axis=1) for part in parts], axis=0)
    finding, factors = units.positions(log, robot, speeds, with_velocities=with_velocities)
    motion = motion.scaled(factors)
    parts = motion.parts()
    moved = movement.range_of_joints(parts, robot)
    explained = whole and moved.status == OK
    suspected = finding.status == FAILED
    found = unlike(robot, motion, suspected=suspected) if explained else None
    if found and found.geared and suspected:  # neither degrees nor mm
        found, finding = found.scaled(factors), ok(finding.name, finding.figure)
    yield finding
    yield movement.standstill(parts)
    yield moved
    yield movement.bandwidths(motion)
    yield movement.resolution(factors[:, None] * log.q, motion, parts, robot)
    yield movement.repetition(motion)
    if explained:
        yield from _explained(log, robot, found)


def _explained(log: Log, robot: Robot, found: Unlike | None) -> Iterator[Finding]:
    """The findings that need the robot's model."""
    if found is None:
        figure = "no row of some joint is away from reversals and standstill"
        yield failed("model", figure, "give a longer log in which every joint moves")
        return
    robot, motion = found.robot, found.motion
    seconds, error, samples = fit.aligned(robot, motion, found.wired.case)
    torques, size = units.torques(log, robot), scale.scale_of(robot, samples)
    motors = found.motors(size)
    yield from found.told(motors)
    yield from wiring.findings(found.wired, robot)
    yield fit.delay(seconds, error, motion)
    if motors and not {*size.low, *size.high} - {*motors}:  # which has been told
        samples = size.corrected(samples)
        size = scale.scale_of(robot, samples)
    if torques.status == FAILED and size.agrees:
        torques = ok(torques.name, torques.figure)  # placeholders, as the masses need just these
    yield torques
    if torques.status != FAILED:
        yield scale.finding(robot, size)
        samples = size.corrected(samples)
    yield from fit.model(robot, samples)
