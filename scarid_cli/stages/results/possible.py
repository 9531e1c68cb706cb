"""The outcome of an identification as estimates that rigid bodies can have (`--consistent`)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.inference.outcome import Outcome
from scarid_cli.algorithms.regression.rows import Rows, regressed
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.possible import Possible, possible
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.residuals import JointResidual
from scarid_cli.errors import BadData, UsageFault


def require_bodies(robot: Robot) -> None:
    """Refuse a robot that is not described by bodies."""
    if not robot.body:
        raise UsageFault(
            f"--consistent: {robot.name} is not described by bodies; it needs a robot of a URDF"
        )


def constrained(found: Outcome, robot: Robot, rows: Rows) -> tuple[Outcome, Possible]:
    """The nearest estimates that rigid bodies can have, and the outcome with their residuals.

    The residuals grow by the torques (of these rows) that the constraint moves; those of the free
    estimates are uncorrelated with them, but for the weights of the fit.
    """
    if found.found.added:
        raise UsageFault("--consistent cannot be combined with --estimator separable")
    covariance = np.array(found.covariance)
    unknown = ~np.isfinite(np.diag(covariance))
    if unknown.all():
        raise BadData("--consistent: the errors of the estimates are not known; use a longer log")
    covariance[unknown, :] = covariance[:, unknown] = np.nan
    dropped = found.reduction.dropped if found.reduction else ()
    half = quantile(0.975, found.diagnostics.blocks - 1.0)
    nearest = possible(robot, found.full.estimates, covariance, tuple(dropped), half)
    free = np.zeros(len(nearest.estimates))
    free[found.kept] = found.found.fit.estimates
    moved = regressed(rows, robot).W @ (nearest.estimates - free)
    counts = rows.scales > 0.0
    added = np.sum(np.where(counts, moved, 0.0) ** 2, axis=0) / np.maximum(counts.sum(axis=0), 1)
    joints = tuple(map(_grown, found.diagnostics.joints, added.tolist()))
    torque = np.array([joint.torque for joint in joints])
    nearest = replace(nearest, moved=np.sqrt(added) / np.where(torque > 0.0, torque, np.inf))
    return replace(found, diagnostics=replace(found.diagnostics, joints=joints)), nearest


def _grown(joint: JointResidual, added: float) -> JointResidual:
    """A residual to whose mean square this is added."""
    if not joint.deviation > 0.0:
        return joint
    factor = 1.0 + added / joint.deviation**2
    return replace(
        joint,
        r2=1.0 - (1.0 - joint.r2) * factor,
        deviation=joint.deviation * factor**0.5,
        relative_error=joint.relative_error * factor**0.5,
    )
