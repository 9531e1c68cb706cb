"""The sensors and the logger that a user's imperfections stand for."""

from __future__ import annotations

from typing import Any

import numpy as np

from scarid_cli.algorithms.imperfections import positions, robot, rows, torques
from scarid_cli.algorithms.imperfections.declared import PerJoint
from scarid_cli.algorithms.imperfections.registry import Imperfections, declared_in
from scarid_cli.algorithms.plants.imperfections import ENCODER_SIDES, Payload, PlantImperfections
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.sensors.clock import Clock
from scarid_cli.algorithms.sensors.faults import Faults, Outliers
from scarid_cli.algorithms.sensors.instants import Path
from scarid_cli.algorithms.sensors.noise import GaussMarkov
from scarid_cli.algorithms.sensors.recorder import Recorder
from scarid_cli.algorithms.sensors.torque import TorqueSensor
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

ECCENTRICITY = (positions.EncoderEccentricity, positions.EncoderTurns, positions.EncoderPhase)
COLOURED = (positions.ColouredPositionNoise, positions.PositionNoiseTime)


def recorder(given: Imperfections, loop: ClosedLoop, keep: int) -> Recorder:
    """The logger that takes a row every `keep` ticks of the controller."""
    control_rate, own = loop.control_rate, loop.imperfections

    def each(kind: type[PerJoint]) -> Array:
        return np.array(given.of(kind))

    return Recorder(
        encoder=loop.encoder,
        torque=TorqueSensor(
            each(torques.TorqueConstantError),
            each(torques.TorqueOffset),
            each(torques.TorqueBandwidth),
            1.0 / control_rate,
        ),
        coloured=GaussMarkov(
            each(torques.ColouredTorqueNoise), each(torques.TorqueNoiseTime), 1.0 / control_rate
        ),
        torque_resolution=each(torques.TorqueResolution),
        position_path=Path.sampled(
            each(positions.PositionRate), each(positions.PositionDelay), control_rate
        ),
        torque_path=Path.sampled(each(torques.TorqueRate), each(torques.TorqueDelay), control_rate),
        clock=Clock(
            keep / control_rate,
            given.one(rows.SamplingJitter),
            given.one(rows.StampJitter),
            given.one(rows.HiddenJitter),
        ),
        faults=Faults(
            Outliers(each(positions.PositionOutliers), each(positions.PositionOutlierSize)),
            Outliers(each(torques.TorqueOutliers), each(torques.TorqueOutlierSize)),
            given.one(rows.RepeatedRows),
            given.one(rows.LostRows),
        ),
        keep=keep,
        control_rate=control_rate,
        held=not (np.any(own.drive_bandwidth) or np.any(own.ripple)),
        on_motor=own.bend and loop.on_motor,
    )


def in_the_loop(
    given: Imperfections, joints: tuple[Joint, ...], control_rate: float
) -> dict[str, Any]:
    """The settings of a `ClosedLoop` for what its controller measures, and for white noise."""
    deviations, times = (np.array(given.of(kind)) for kind in COLOURED)
    noise = given.of(torques.TorqueNoise)
    if not given.has(torques.TorqueNoise):
        noise = tuple(joint.torque_noise for joint in joints)
    return {
        "encoder_resolution": _resolutions(given, joints),
        "position_noise": np.array(given.of(positions.PositionNoise)),
        "torque_noise": np.array(noise),
        "eccentricity": tuple(np.array(given.of(kind)) for kind in ECCENTRICITY),
        "imperfections": of_the_robot(given),
        "coloured": GaussMarkov(deviations, times, 1.0 / control_rate)
        if deviations.any()
        else None,
    }


def of_the_robot(given: Imperfections) -> PlantImperfections:
    """The imperfections of the plant; their names are those of the fields."""
    values: dict[str, Any] = {}
    for kind in declared_in("Robot"):
        if given.has(kind):
            own = given.of(kind)
            name = kind.NAME.replace("-", "_")
            values[name] = np.array(own) if kind.PER_JOINT else own[0] if len(own) == 1 else own
    if given.has(robot.EncoderSide):
        values["encoder_side"] = ENCODER_SIDES[int(values["encoder_side"])]
    if given.has(robot.Payload):
        values["payload"] = _payload(*given.of(robot.Payload))
    return PlantImperfections(**values)


def _payload(mass: float, *numbers: float) -> Payload:
    """The payload of eleven numbers; a body has a density that is nowhere negative."""
    centre, moments, start = numbers[:3], numbers[3:9], numbers[9]
    xx, xy, xz, yy, yz, zz = moments
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    spread = 0.5 * np.trace(inertia) * np.eye(3) - inertia
    if np.linalg.eigvalsh(spread)[0] < -1e-9 * np.trace(inertia):
        raise UsageFault(
            "payload: no body has these moments of inertia; none may exceed the sum of the others"
        )
    return Payload(mass, centre, moments, start)


def _resolutions(given: Imperfections, joints: tuple[Joint, ...]) -> Array:
    """The resolution of each encoder [rad or m]; 0 for a perfect one."""
    own = np.array([joint.encoder_resolution for joint in joints])
    if not given.has(positions.EncoderBits):
        return own
    bits = np.array(given.of(positions.EncoderBits))
    turning = np.array([joint.type == "revolute" for joint in joints])
    return np.where(turning, np.where(bits > 0.0, 2.0 * np.pi / 2.0**bits, 0.0), own)


def jitters(given: Imperfections) -> bool:
    """Whether rows are sampled or stamped at other times than the nominal ones."""
    return any(
        given.one(kind) for kind in (rows.SamplingJitter, rows.StampJitter, rows.HiddenJitter)
    )
