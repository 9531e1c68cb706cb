"""Measured velocities against the positions: the clock, units, signs and the order of columns.

Over a stretch of the log the way of a joint is the sum of its velocities times the time. The slope
of one on the other, for each pair of columns, is 1 if clock and units are right and the columns are
those of one joint. One factor for all joints is the clock's, or a unit of all velocities.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, warning
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.arrays import Array, median

STRETCH = 0.1  # s: longer than what a driver delays or filters velocities by
ALIKE = 0.9  # correlation of ways, from which on two columns are of one joint
AS_WELL = 0.05  # of a correlation, by which another joint must fit better to be the one
RIGHT = 0.05  # of a slope: by which velocities may be off, as filtered ones are
UNITS = {180.0 / pi: "deg/s", 30.0 / pi: "rpm", 1000.0: "mm/s or mrad/s", 0.5 / pi: "turns/s"}


@dataclass(frozen=True)
class Relation:
    """For each column of velocities: the joint (from 0) whose ways it has, and its slope."""

    joint: tuple[int, ...]
    slope: Array


def in_step(related: Relation | None) -> bool:
    """Whether each velocity is that of its position, in the same unit."""
    if related is None or related.joint != tuple(range(len(related.joint))):
        return False
    return bool(np.all(np.abs(related.slope - 1.0) < RIGHT))


def relation(log: Log, period: float) -> Relation | None:
    """How velocities and positions of a log are related; None if nothing moves, or none has any."""
    if log.dq is None or not period:
        return None
    rows = max(2, round(STRETCH / period))
    ways, sums = _ways(log.t, log.q, log.dq, rows)
    sizes = np.sqrt(np.sum(ways**2, axis=1)), np.sqrt(np.sum(sums**2, axis=1))
    if not (np.all(sizes[0] > 0.0) and np.all(sizes[1] > 0.0)):
        return None
    products = ways @ sums.T  # joints, columns
    correlation = products / np.outer(*sizes)
    joints, slopes = [], []
    for k in range(len(log.dq)):
        best = int(np.argmax(np.abs(correlation[:, k])))
        own = abs(correlation[k, k]) > abs(correlation[best, k]) - AS_WELL
        joint = k if own else best
        if abs(correlation[joint, k]) < ALIKE:
            return None
        joints.append(joint)
        slopes.append(np.sign(products[joint, k]) * sizes[1][k] / sizes[0][joint])
    return Relation(tuple(joints), np.array(slopes))


def _ways(t: Array, q: Array, dq: Array, rows: int) -> tuple[Array, Array]:
    """The ways of joints, and the sums of velocities times the time (joints, stretches)."""
    whole = np.isfinite(t) & np.all(np.isfinite(q), axis=0) & np.all(np.isfinite(dq), axis=0)
    t, q, dq = t[whole], q[:, whole], dq[:, whole]
    steps = 0.5 * (dq[:, 1:] + dq[:, :-1]) * np.diff(t)
    sums = np.concatenate((np.zeros((len(q), 1)), np.cumsum(steps, axis=1)), axis=1)
    ends = np.arange(0, len(t), rows)
    apart = np.diff(t[ends])
    short = apart < 2.0 * median(apart) if len(apart) else np.zeros(0, dtype=bool)
    return np.diff(q[:, ends])[:, short], np.diff(sums[:, ends])[:, short]


def finding(found: Relation | None, period: float) -> Finding:
    """What the relation of velocities and positions says."""
    if found is None:
        return ok("velocities", "not comparable with the positions")
    moved = [k + 1 for k, joint in enumerate(found.joint) if joint != k]
    if moved:
        figure = f"the velocities of {joints_text(moved)} are those of other joints"
        return failed("velocities", figure, "the columns seem exchanged: `scarid convert --map`")
    sizes = np.abs(found.slope)
    if backward := [k + 1 for k, slope in enumerate(found.slope) if slope < 0.0]:
        figure = f"the velocity of {joints_text(backward)} has the other sign than its position"
        return failed("velocities", figure, "reversed, or the position is: look at both")
    listed = ", ".join(f"{x:.3g}" for x in sizes)
    figure = f"{listed} times the changes of the positions"
    off = np.abs(np.log(sizes)) > np.log1p(RIGHT)
    if not off.any():
        return ok("velocities", figure)
    common = float(np.exp(np.mean(np.log(sizes))))
    alike = np.all(np.abs(np.log(sizes / common)) < np.log1p(RIGHT))
    for factor, unit in UNITS.items():
        if alike and abs(np.log(common / factor)) < np.log1p(RIGHT):
            advice = f"velocities in {unit}? `scarid convert --unit 'dq*={unit.split()[0]}'`"
            return failed("velocities", figure, advice)
    if alike and len(sizes) > 1:
        rate = common / period
        advice = (
            f"the clock is wrong, or the unit of the velocities: they fit a rate of {rate:.4g} Hz, "
            f"not {1.0 / period:.4g} Hz: `scarid convert --unit 't={1.0 / common:.4g} s'`"
        )
        return failed("clock", f"velocities {figure}", advice)
    names = joints_text((np.flatnonzero(off) + 1).tolist())
    advice = f"are velocity and position of {names} in one unit, and of one sensor?"
    return warning("velocities", figure, advice)
