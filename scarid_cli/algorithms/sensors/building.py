"""The sensors and the logger that a user's imperfections stand for."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.imperfections import positions, rows, torques
from scarid_cli.algorithms.imperfections.declared import PerJoint
from scarid_cli.algorithms.imperfections.registry import Imperfections
from scarid_cli.algorithms.sensors.clock import Clock
from scarid_cli.algorithms.sensors.faults import Faults, Outliers
from scarid_cli.algorithms.sensors.instants import Path
from scarid_cli.algorithms.sensors.motion import Encoder
from scarid_cli.algorithms.sensors.noise import GaussMarkov
from scarid_cli.algorithms.sensors.recorder import Recorder
from scarid_cli.algorithms.sensors.torque import TorqueSensor
from scarid_cli.arrays import Array

ECCENTRICITY = (positions.EncoderEccentricity, positions.EncoderTurns, positions.EncoderPhase)


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


def eccentricity(given: Imperfections) -> tuple[Array, Array, Array]:
    """The amplitude, turns and phase of the encoders (see `Encoder`)."""
    amplitude, turns, phase = (np.array(given.of(kind)) for kind in ECCENTRICITY)
    return amplitude, turns, phase


def position_noise(given: Imperfections, control_rate: float) -> GaussMarkov | None:
    """The coloured noise of the positions, if there is any."""
    deviations = np.array(given.of(positions.ColouredPositionNoise))
    times = np.array(given.of(positions.PositionNoiseTime))
    return GaussMarkov(deviations, times, 1.0 / control_rate) if deviations.any() else None


def jitters(given: Imperfections) -> bool:
    """Whether rows are sampled or stamped at other times than the nominal ones."""
    return any(
        given.one(kind) for kind in (rows.SamplingJitter, rows.StampJitter, rows.HiddenJitter)
    )
