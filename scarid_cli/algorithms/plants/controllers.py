"""The controllers of a simulated robot, and gains where its description has none."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.definite import random_postures
from scarid_cli.algorithms.plants.model import Model, inertia, model
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

KINDS = {"pd": 0, "pid": 0, "pd-gravity": 1, "computed-torque": 2}  # their numbers in the kernel
DEFAULT_KIND = "computed-torque"
DESCRIBED_KIND = "pid"  # of a [control] that names none (paper eq. 29)
BANDWIDTH = 5.0  # Hz
DAMPING = 1.0
INTEGRAL = 0.1  # rate of the integral action of `pid`, per natural frequency
CUTOFF = 4.0  # of the velocity estimate, per bandwidth
POSTURES = 200


@dataclass(frozen=True)
class Law:
    """A controller; arrays have one value per joint.

    tau = Kp e + Kd de/dt + Ki integral(e), with e = q_ref - q (paper eq. 29); `pd-gravity` adds the
    gravity of the a priori model. For `computed-torque` this sum, plus the acceleration wanted, is
    an acceleration, for which the a priori model gives the torques. Gains [N m/rad, N m s/rad, N
    m/(rad s)], or of `computed-torque` [1/s2, 1/s, 1/s3]; the cut-off [Hz] of the low-pass of the
    differentiated encoder, 0 for none.
    """

    kp: Array
    kd: Array
    ki: Array
    velocity_cutoff: float
    kind: str = DESCRIBED_KIND


def law(
    robot: Robot, kind: str | None = None, bandwidth: float | None = None, **gains: Array | None
) -> Law:
    """The controller of a robot: of its description, or found from a bandwidth [Hz].

    Gains (`kp`, `kd`, `ki`) that are given replace those of the description or of the bandwidth.
    """
    own = robot.control
    described = own.kind if own else DEFAULT_KIND
    kind = kind or described
    if kind not in KINDS:
        raise UsageFault(f"there is no controller {kind!r}; choose {', '.join(KINDS)}")
    fits = (kind == "computed-torque") == (described == "computed-torque")
    found: dict[str, Any]
    if own and own.kp and fits and bandwidth is None:
        found = {name: np.array(getattr(own, name)) for name in ("kp", "kd", "ki")}
        found["velocity_cutoff"] = own.velocity_cutoff
    else:
        found = gains_of(robot, kind, bandwidth or (own and own.bandwidth) or BANDWIDTH)
    found.update({name: value for name, value in gains.items() if value is not None})
    if kind == "pd":
        found["ki"] = np.zeros(len(robot.joints))
    return Law(**found, kind=kind)


def gains_of(robot: Robot, kind: str, bandwidth: float) -> dict[str, Any]:
    """Gains of two equal poles at the bandwidth [Hz], for the typical inertia of each joint."""
    if not bandwidth > 0.0:
        raise UsageFault("--bandwidth: must be positive")
    omega = 2.0 * np.pi * bandwidth
    ones = np.ones(len(robot.joints))
    size = ones if kind == "computed-torque" else typical_inertia(model(robot), robot)
    kp = omega * omega * size
    ki = INTEGRAL * omega * kp if kind == "pid" else 0.0 * ones
    return {
        "kp": kp,
        "kd": 2.0 * DAMPING * omega * size,
        "ki": ki,
        "velocity_cutoff": CUTOFF * bandwidth,
    }


def typical_inertia(arm: Model, robot: Robot) -> Array:
    """The median inertia of each joint (joints) over random postures within its limits.

    It is the one that a torque finds while the other joints are free, 1 / (M^-1)_ii. Gains for the
    diagonal of M let the joints of light wrists oscillate.
    """
    postures = random_postures(robot, POSTURES)
    sizes = [1.0 / np.diag(np.linalg.inv(inertia(arm, q))) for q in postures]
    return np.asarray(np.median(sizes, axis=0), dtype=np.float64)
