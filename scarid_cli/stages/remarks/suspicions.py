"""What is not in order with a log beside the model of its robot, as `identify` finds it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.checks import gearing, mounting, scale, search, velocities, wiring
from scarid_cli.algorithms.checks.finding import FAILED, OK, TORQUES, Finding
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.checks.model import Samples, enough
from scarid_cli.algorithms.inference.verdict import CAUSE
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot

OFF = 1.5  # times the changes of positions: velocities that are further off are others
FEWEST = 100  # rows of each joint with which the description is put to the test


def without_placeholders(findings: list[Finding], rows: Rows, robot: Robot) -> list[Finding]:
    """The findings, but for torques far from their limits if they are those that masses need."""
    if not any(finding.name == TORQUES and finding.status == FAILED for finding in findings):
        return findings
    samples = _samples(rows, robot)
    if samples is None or not scale.scale_of(robot, samples).agrees:
        return findings
    return [finding for finding in findings if finding.name != TORQUES]


def of_velocities(rows: Rows) -> list[Finding]:
    """Velocities of a motion that are no changes of its positions: another unit, sign or joint.

    What filters leave of fast motions is less, but not by half.
    """
    q, dq = rows.motion[0], rows.motion[1]
    log = Log(np.asarray(rows.h * rows.at, np.float64), q, rows.motion[3], dq=dq)
    relation = velocities.relation(log, rows.h)
    if relation is None:
        return []
    apart = any(j != k for k, j in enumerate(relation.joint)) or np.any(relation.slope < 0.0)
    if not apart and np.all(np.abs(np.log(relation.slope)) < np.log(OFF)):
        return []
    found = velocities.finding(relation, rows.h)
    return [found] if found.status == FAILED else []


def of_model(rows: Rows, robot: Robot, *, loaded: bool = False) -> list[Finding]:
    """Axes, zeros, gravity and signs unlike in the description, and torques in another unit.

    What a `loaded` robot carries is not described: only one unit of all torques is then told. A
    torque that never changes, as of a joint without a motor, says nothing about them.
    """
    samples = _samples(rows, robot)
    if samples is None:
        return []
    driven = np.all(np.ptp(samples.motion[3], axis=1) > 0.0)
    unlike = _described(samples, robot) if driven else []
    return unlike or _scale(samples, robot, loaded=loaded)


def _samples(rows: Rows, robot: Robot) -> Samples | None:
    """The rows that are put to the test; None if they are too few."""
    if rows.samples < FEWEST or not np.all(np.count_nonzero(rows.scales, axis=0) >= FEWEST):
        return None
    return Samples.of_rows(rows, enough(robot))


def _described(samples: Samples, robot: Robot) -> list[Finding]:
    """What is unlike in the description, by what explains the torques best.

    Signals of other joints and single signs are tried where the model leaves what a wrong one would
    leave.
    """
    mounted = mounting.mounted(robot, samples)
    if mounted.fit.residuals.max() > mounting.TURNED:
        wired = wiring.wired(robot, samples)
        better = wired.fit.misfit < mounted.fit.misfit + np.log(search.FALL)
        if wired.case.exchanged and better and wired.fit.residuals.max() <= mounting.UNEXPLAINED:
            return [x for x in wiring.findings(wired, robot) if x.status == FAILED]
        signed = wiring.signed(robot, samples)
        some = len(set(signed.case.signs[1])) > 1
        explained = signed.fit.residuals.max() <= mounting.UNEXPLAINED
        if some and explained and signed.fit.misfit < mounted.fit.misfit:
            return [wiring.signs(signed, robot)]
        geared = gearing.geared(robot, samples)
        if gearing.better(geared, mounted.fit, robot, samples):
            return gearing.findings(geared.case)
    return mounting.findings(mounted.case)


def _scale(samples: Samples, robot: Robot, *, loaded: bool) -> list[Finding]:
    """Torques in another unit, or all of them reversed.

    That all friction is negative then is a reason of the verdict by itself. Torques of some joints
    that are too large or small may be those of other joints, for which only `check` searches.
    """
    size = scale.scale_of(robot, samples)
    if size.reversed:
        signed = wiring.signed(robot, samples)
        told = signed.fit.brakes or all(sign > 0 for sign in signed.case.signs[1])
        return [] if told else [wiring.signs(signed, robot)]
    if loaded and not size.of_a_unit:
        return []
    found = scale.finding(robot, size)
    if len(size.low or size.high) < len(robot.joints):
        found = replace(found, advice=f"{found.advice}; {CAUSE}")
    return [found] if found.status != OK else []
