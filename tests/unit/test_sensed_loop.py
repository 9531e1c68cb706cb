"""A simulated robot whose controller takes the velocities of a soft sensor (paper eq. 29)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from stages.tables import SCARA

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.arrays import Array

H = 1e-3
RESOLUTION = np.full(2, 2.0 * np.pi / 2**17)


def reference(ticks: int) -> tuple[Array, Array, Array]:
    t = np.arange(ticks) * H
    a, w = np.array([[0.8], [0.6]]), np.array([[2.0], [3.0]])
    return a * (1.0 - np.cos(w * t)), a * w * np.sin(w * t), a * w * w * np.cos(w * t)


def loop(sensor: Any) -> ClosedLoop:
    noise = np.full(2, 1e-5)
    sensors = [sensor] * 2 if sensor else None
    return ClosedLoop(SCARA, law(SCARA, "pd"), RESOLUTION, noise, 0.0 * noise, 0, sensors=sensors)


def followed(sensor: Any, ticks: int = 400, parts: int = 1) -> LoopLog:
    plant = loop(sensor)
    motion = reference(ticks)
    state, logs = plant.init(motion[0][:, 0]), []
    for part in np.array_split(np.arange(ticks), parts):
        state, log = plant.step(state, *(np.ascontiguousarray(x[:, part]) for x in motion))
        logs.append(log)
    joined = (
        np.concatenate([getattr(x, n) for x in logs], axis=1) for n in LoopLog.__annotations__
    )
    return LoopLog(*joined)


CAUSAL = ["2smd", "astd", "ed-fir", "p2smd", "kalman", "backward", "high-gain", "implicit-levant"]


@pytest.mark.parametrize("name", CAUSAL)
def test_the_controller_takes_what_differentiate_makes_of_the_readings(name: str) -> None:
    """The commands are those of eq. 29 with velocities of the whole recorded positions at once."""
    sensor = DIFFERENTIATORS.load(name)()
    log, own = followed(sensor, 300), loop(sensor).law
    q_ref, dq_ref, _ = reference(300)
    for j in range(2):
        v = sensor.step(sensor.init(float(log.q[j, 0]), H), np.ascontiguousarray(log.q[j]))[1][0]
        e, rate = q_ref[j] - log.q[j], dq_ref[j] - v
        wanted = own.kp[j] * e + own.kd[j] * rate + 0.0
        limit = SCARA.joints[j].torque_limit
        np.testing.assert_array_equal(log.command[j], np.clip(wanted, -limit, limit))


def test_the_log_is_the_same_however_the_reference_arrives() -> None:
    sensor = DIFFERENTIATORS.load("p2smd")()
    whole, parts = followed(sensor), followed(sensor, parts=7)
    for name in ("q", "command", "dq_true"):
        np.testing.assert_array_equal(getattr(whole, name), getattr(parts, name))


def test_a_smooth_sensor_makes_smooth_torques() -> None:
    rough, smooth = (followed(DIFFERENTIATORS.load(n)()) for n in ("backward", "kalman"))
    changes = [np.std(np.diff(log.command, axis=1), axis=1) for log in (rough, smooth)]
    assert np.all(changes[1] < 0.2 * changes[0])
