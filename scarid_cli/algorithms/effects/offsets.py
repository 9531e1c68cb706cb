"""Offsets of the torques, of joints for which the robot has no such parameter.

Drives and torque sensors have zeros that drift, and an offset that is not fitted moves friction and
whatever else is not symmetric in the motion. Where the log clearly shows one, it is a nuisance
parameter, as the delay of the torques is: a property of the log.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.estimators import wls
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, thinned
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.terms import Offset
from scarid_cli.algorithms.uncertainty.jackknife import jackknife, quantile
from scarid_cli.arrays import Array

CERTAIN = 0.01  # probability of calling any of the offsets one that is none
NOTHING = 1e-4  # of a torque: no sensor shows as little


def offset_joints(robot: Robot) -> dict[int, int]:
    """The parameters (by index) of the robot that are offsets, with their joints (from 0)."""
    terms = ((k, parameter.term) for k, parameter in enumerate(robot.parameters))
    return {k: term.joints[0] - 1 for k, term in terms if isinstance(term, Offset)}


def offsets(rows: Rows, robot: Robot, others: Collection[int] = ()) -> tuple[int, ...]:
    """The joints (from 0) whose torques clearly have an offset that the robot has not.

    The `others` have a column for it already.
    """
    known = {*offset_joints(robot).values(), *others}
    joints = tuple(j for j in range(rows.y.shape[1]) if j not in known)
    if not joints or not rows.h > 0.0:
        return ()
    few = with_offsets(thinned(rows), joints)
    try:
        found = wls.Estimator().of_rows(few)
    except NotIdentifiableError:
        return ()
    scatter = jackknife(few, found)
    least = quantile(1.0 - 0.5 * CERTAIN / len(joints), scatter.effective - 1.0)
    sizes = np.abs(found.fit.estimates[-len(joints) :])
    errors, usual = scatter.errors[-len(joints) :], _torques(few)[list(joints)]
    clear = sizes > np.maximum(least * errors, NOTHING * usual)
    return tuple(j for j, there in zip(joints, clear, strict=True) if there)


def with_offsets(rows: Rows, joints: tuple[int, ...]) -> Rows:
    """The rows with further columns: 1 for each of these joints (from 0)."""
    if not joints:
        return rows
    columns = np.zeros((*rows.y.shape, len(joints)))
    columns[:, joints, np.arange(len(joints))] = 1.0
    return replace(rows, W=np.concatenate((rows.W, columns), axis=2))


def _torques(rows: Rows) -> Array:
    """The root mean square of the torque of each joint (joints) over the rows that count."""
    counts = rows.scales > 0.0
    squares = np.sum(rows.y**2 * counts, axis=0)
    return np.asarray(np.sqrt(squares / np.maximum(counts.sum(axis=0), 1)))
