"""The motion of a simulated robot that follows the reference of a log, with given parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop, DivergedError, IndefiniteError
from scarid_cli.algorithms.regression.rows import Rows, runs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.hermite import refine
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

CONTROL_RATE = 1000.0  # Hz
SETTLING = 0.5  # s: until a simulation that starts at rest follows its reference


def simulated(robot: Robot, theta: Array, rows: Rows) -> Rows:
    """The rows along the noise-free motion of the robot with the parameters theta.

    Rows are left out, and their W is zero, until each simulation has settled.
    """
    assert rows.reference is not None
    W, scales, motion = np.zeros_like(rows.W), np.zeros_like(rows.scales), rows.motion.copy()
    settling = round(SETTLING / rows.h)
    for run in runs(rows.at):
        reference = rows.reference[:, :, run]
        if reference.shape[2] > 2 * settling:
            followed = _followed(robot, theta, reference, rows.h)
            settled = slice(run.start + settling, run.stop)
            W[settled] = robot.regressor(*followed[:, :, settling:])
            scales[settled] = rows.scales[settled]
            motion[:3, :, run] = followed
    return replace(rows, W=W, scales=scales, motion=motion)


def _followed(robot: Robot, theta: Array, reference: Array, h: float) -> Array:
    """Position, velocity and acceleration (3, joints, samples) in closed loop."""
    joints = len(robot.joints)
    ratio = max(1, round(h * CONTROL_RATE))
    parameters = zip(robot.parameters, theta.tolist(), strict=True)
    own = replace(robot, parameters=tuple(replace(p, apriori=x) for p, x in parameters))
    loop = ClosedLoop(
        robot=own,
        law=law(robot),
        encoder_resolution=np.zeros(joints),
        position_noise=np.zeros(joints),
        torque_noise=np.zeros(joints),
        seed=0,
        control_rate=ratio / h,
        apriori=robot,
    )
    q, dq = reference
    fine = refine(q, dq, np.gradient(dq, h, axis=1), h, ratio)
    try:
        log = loop.step(loop.init(fine[0][:, 0]), *fine)[1]
    except DivergedError:
        raise UsageFault(
            f"robot {robot.name}: its simulation with the controller of the description becomes "
            "unstable; correct [control], or use --estimator wls"
        ) from None
    except IndefiniteError:
        raise UsageFault(
            f"robot {robot.name}: the inertia matrix of the estimates is not positive definite, so "
            "they cannot be simulated; check the controller of the description, or use "
            "--estimator wls"
        ) from None
    signals = np.stack((log.q_true, log.dq_true, log.ddq_true))[:, :, ::ratio]
    # The simulation ends one sample early, since nothing follows the last reference.
    return np.ascontiguousarray(np.pad(signals, ((0, 0), (0, 0), (0, 1)), "edge"))
