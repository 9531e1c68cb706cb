"""The sensors and the logger that a user's imperfections stand for."""

from __future__ import annotations

from typing import Any

import numpy as np

from scarid_cli.algorithms.imperfections import positions, rows, torques
from scarid_cli.algorithms.imperfections.declared import PerJoint
from scarid_cli.algorithms.imperfections.registry import Imperfections
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.sensors.clock import Clock
from scarid_cli.algorithms.sensors.faults import Faults, Outliers
from scarid_cli.algorithms.sensors.instants import Path
from scarid_cli.algorithms.sensors.motion import Encoder
from scarid_cli.algorithms.sensors.noise import GaussMarkov
from scarid_cli.algorithms.sensors.recorder import Recorder
from scarid_cli.algorithms.sensors.torque import TorqueSensor
from scarid_cli.arrays import Array

ECCENTRICITY = (positions.EncoderEccentricity, positions.EncoderTurns, positions.EncoderPhase)
COLOURED = (positions.ColouredPositionNoise, positions.PositionNoiseTime)


def recorder(given: Imperfections, encoder: Encoder, control_rate: float, keep: int) -> Recorder:
    """The logger that takes a row every `keep` ticks of a controller with this rate [Hz]."""

    def each(kind: type[PerJoint]) -> Array:
        return np.array(given.of(kind))

    return Recorder(
        encoder=encoder,
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
        "coloured": GaussMarkov(deviations, times, 1.0 / control_rate)
        if deviations.any()
        else None,
    }


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
