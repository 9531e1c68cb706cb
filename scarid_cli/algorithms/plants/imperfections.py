"""What distinguishes a real robot from the rigid-body model of its description.

Each value is one number for all joints or an array (joints), in the units of the joint; zero leaves
an imperfection out. docs/simulator.md has the equation of each.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import inf

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

PerJoint = float | Array
ENCODER_SIDES = ("motor", "link")


@dataclass(frozen=True)
class Payload:
    """A body on the last link from a time on [s]; it starts with the velocity of the link.

    Mass [kg], centre of mass (3) in the frame of the last link [m], and the moments of inertia
    Ixx, Ixy, Ixz, Iyy, Iyz, Izz (6) about the centre of mass [kg m2].
    """

    mass: float
    centre: tuple[float, ...] = (0.0, 0.0, 0.0)
    inertia: tuple[float, ...] = (0.0,) * 6
    start: float = 0.0


@dataclass(frozen=True)
class PlantImperfections:
    """The imperfections of the robot itself, between the commanded torque and the true motion."""

    drive_bandwidth: PerJoint = 0.0  # Hz, of the first-order lag of the torque; 0: no lag
    motor_gain: PerJoint = 0.0  # e: the actual torque is (1 + e) times the commanded one
    ripple: PerJoint = 0.0  # amplitude of the torque ripple [N m or N]
    ripple_cycles: PerJoint = 0.0  # periods of the ripple per rad or m
    stribeck: PerJoint = 0.0  # friction at standstill beyond the Coulomb friction [N m or N]
    stribeck_velocity: PerJoint = 0.1  # rad/s or m/s
    load_friction: PerJoint = 0.0  # Coulomb friction per transmitted torque
    friction_asymmetry: PerJoint = 0.0  # e: Coulomb friction (1 + e) forward, (1 - e) backward
    friction_drift: PerJoint = 0.0  # e: all friction grows by the factor 1 + e (1 - exp(-t/T))
    friction_drift_time: PerJoint = 60.0  # T [s]
    flexibility: PerJoint = 0.0  # Hz, natural frequency with the motor locked; 0: rigid joint
    flexibility_damping: PerJoint = 0.05  # damping ratio of the same oscillation
    motor_share: PerJoint = 0.3  # motor inertia per link inertia, where the description has none
    encoder_side: str = "motor"  # of flexible joints: "motor" or "link"
    vibration: float = 0.0  # amplitude of the acceleration of the base [m/s2]
    vibration_frequency: float = 0.0  # Hz
    vibration_direction: tuple[float, ...] = (1.0, 0.0, 0.0)  # in the frame of the base
    payload: Payload | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if field.name not in SIGNED and isinstance(value, int | float | np.ndarray):
                _check(field.name, value, 0.0, "must not be negative")
        for name in ("stribeck_velocity", "friction_drift_time"):
            _check(name, getattr(self, name), np.nextafter(0.0, 1.0), "must be positive")
        for name in ("motor_gain", "friction_drift"):
            _check(name, getattr(self, name), -1.0, "must not be below -1")
        if self.encoder_side not in ENCODER_SIDES:
            raise UsageFault(f"encoder side {self.encoder_side!r}: choose motor or link")

    @property
    def rub(self) -> bool:
        """Whether the friction is not that of the description."""
        names = ("stribeck", "load_friction", "friction_asymmetry", "friction_drift")
        return any(np.any(np.asarray(getattr(self, name)) != 0.0) for name in names)

    @property
    def bend(self) -> bool:
        """Whether a joint is flexible."""
        return bool(np.any(np.asarray(self.flexibility) > 0.0))

    def of(self, name: str, joints: int) -> Array:
        """The values (joints) of one of the fields of each joint."""
        return np.array(np.broadcast_to(getattr(self, name), joints), dtype=np.float64)


SIGNED = ("motor_gain", "friction_asymmetry", "friction_drift")


def _check(name: str, value: PerJoint, least: float, complaint: str) -> None:
    if not np.all((np.asarray(value) >= least) & (np.asarray(value) < inf)):
        raise UsageFault(f"{name.replace('_', ' ')} {complaint}, and finite")
