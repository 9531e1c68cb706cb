"""Imperfections of the robot itself, between the commanded torque and the true motion.

The names are those of the fields of `plants.imperfections.PlantImperfections`.
"""

from __future__ import annotations

from scarid_cli.algorithms.imperfections.declared import (
    TORQUE,
    Number,
    OfTheRobot,
    PerJoint,
)


class DriveBandwidth(PerJoint):
    """Bandwidth of the lag of the drive's torque (0: none).

    A first-order lag: d(tau)/dt = 2 pi f (command - tau), with the bandwidth f. The log has the
    command.
    """

    NAME = "drive-bandwidth"
    NUMBERS = (Number("Hz", low=0.0),)


class MotorGain(PerJoint):
    """Relative error of the torque that the motor makes.

    true = (1 + e) commanded. The log has the command.
    """

    NAME = "motor-gain"
    NUMBERS = (Number(low=-1.0),)


class Ripple(PerJoint):
    """Amplitude of the torque ripple of the motor.

    A sin(2 pi n q) is added to the torque, with the amplitude A, n of `ripple-cycles` and the
    position q of the motor's side of the joint.
    """

    NAME = "ripple"
    NUMBERS = (Number(TORQUE, low=0.0),)
    NEEDS = "ripple-cycles"


class RippleCycles(PerJoint):
    """Periods of the torque ripple per rad or m of the joint."""

    NAME = "ripple-cycles"
    NUMBERS = (Number("1/rad or 1/m", low=0.0),)
    NEEDS = "ripple"


class Stribeck(PerJoint):
    """Friction at standstill beyond the Coulomb friction.

    At the velocity v it is s exp(-(v / v_s)^2), with s and v_s of `stribeck-velocity`.
    """

    NAME = "stribeck"
    NUMBERS = (Number(TORQUE, low=0.0),)


class StribeckVelocity(PerJoint):
    """Velocity at which Stribeck friction has fallen to 1/e."""

    NAME = "stribeck-velocity"
    NUMBERS = (Number("rad/s or m/s", low=0.0, default=0.1),)
    NEEDS = "stribeck"


class LoadFriction(PerJoint):
    """Coulomb friction per torque that the joint transmits."""

    NAME = "load-friction"
    NUMBERS = (Number(low=0.0, high=0.99),)


class FrictionAsymmetry(PerJoint):
    """Difference of the Coulomb friction between both directions.

    It is (1 + e) times that of the description forwards, and (1 - e) times backwards.
    """

    NAME = "friction-asymmetry"
    NUMBERS = (Number(low=-1.0, high=1.0),)


class FrictionDrift(PerJoint):
    """Relative growth of all friction with time.

    At the time t it is 1 + e (1 - exp(-t / T)) times that at the start, with T of
    `friction-drift-time`. It is negative for a robot that warms up.
    """

    NAME = "friction-drift"
    NUMBERS = (Number(low=-1.0),)


class FrictionDriftTime(PerJoint):
    """Time constant of the drift of the friction."""

    NAME = "friction-drift-time"
    NUMBERS = (Number("s", low=0.0, default=60.0),)
    NEEDS = "friction-drift"


class Flexibility(PerJoint):
    """Natural frequency of a flexible joint, its motor locked.

    0 is a rigid joint. The stiffness is that of the joint's inertia at this frequency.
    """

    NAME = "flexibility"
    NUMBERS = (Number("Hz", low=0.0),)


class FlexibilityDamping(PerJoint):
    """Damping ratio of the oscillation of a flexible joint."""

    NAME = "flexibility-damping"
    NUMBERS = (Number(low=0.0, default=0.05),)
    NEEDS = "flexibility"


class MotorShare(PerJoint):
    """Motor inertia per link inertia of a flexible joint.

    It is used where the description states no motor inertia.
    """

    NAME = "motor-share"
    NUMBERS = (Number(low=0.0, default=0.3),)
    NEEDS = "flexibility"


class EncoderSide(OfTheRobot):
    """Side of flexible joints on which the encoders are."""

    NAME = "encoder-side"
    NUMBERS = (Number(words=("motor", "link")),)
    NEEDS = "flexibility"


class Vibration(OfTheRobot):
    """Amplitude of the acceleration of a vibrating base.

    The acceleration is A sin(2 pi f t), with f of `vibration-frequency` and the direction of
    `vibration-direction` in the frame of the base.
    """

    NAME = "vibration"
    NUMBERS = (Number("m/s2", low=0.0),)
    NEEDS = "vibration-frequency"


class VibrationFrequency(OfTheRobot):
    """Frequency of the vibration of the base."""

    NAME = "vibration-frequency"
    NUMBERS = (Number("Hz", low=0.0),)
    NEEDS = "vibration"


class VibrationDirection(OfTheRobot):
    """Direction x,y,z of the vibration in the base's frame."""

    NAME = "vibration-direction"
    NUMBERS = (Number(what="x", default=1.0), Number(what="y"), Number(what="z"))
    NEEDS = "vibration"


class Payload(OfTheRobot):
    """Payload: mass,cx,cy,cz,Ixx,Ixy,Ixz,Iyy,Iyz,Izz,from.

    A body on the last link: its mass [kg], its centre of mass in the frame of the last link [m],
    its moments of inertia about the centre of mass [kg m2], and the time from the start of the log
    on from which it is there [s].
    """

    NAME = "payload"
    NUMBERS = (
        Number("kg", low=0.0, what="mass"),
        *(Number("m", what=axis) for axis in ("cx", "cy", "cz")),
        Number("kg m2", low=0.0, what="Ixx"),
        Number("kg m2", what="Ixy"),
        Number("kg m2", what="Ixz"),
        Number("kg m2", low=0.0, what="Iyy"),
        Number("kg m2", what="Iyz"),
        Number("kg m2", low=0.0, what="Izz"),
        Number("s", low=0.0, what="from"),
    )
