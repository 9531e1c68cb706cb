"""The loop around the simulated robot: its controller, encoder and noise, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from unit.plants import (
    GAINS,
    RATE,
    SMOOTH,
    closed_loop,
    push,
    reference,
)
from unit.support import adjusted, cuts

from scarid_cli.algorithms.plants.loop import ClosedLoop, DivergedError, IndefiniteError
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


def test_torque_is_equation_29_on_what_the_encoder_says() -> None:
    """Worked out again from the log, with the smoothed backward difference for velocity."""
    robot = adjusted("scara2")
    ki, cutoff = np.array([5.0, 0.5]), 20.0
    loop = closed_loop(
        robot, **GAINS, ki=ki, velocity_cutoff=cutoff, encoder_resolution=np.full(2, 1e-4)
    )
    q_ref, dq_ref, ddq_ref = reference(2, 1000)
    _, log = loop.step(loop.init(np.zeros(2)), q_ref, dq_ref, ddq_ref)
    smooth = np.exp(-2.0 * np.pi * cutoff / RATE)
    dq, expected = np.zeros(2), np.empty((2, 1000))
    for k in range(1000):
        difference = (log.q[:, k] - log.q[:, max(k - 1, 0)]) * RATE
        dq = smooth * dq + (1.0 - smooth) * difference
        error = q_ref[:, : k + 1] - log.q[:, : k + 1]
        integral = ki * error.sum(axis=1) / RATE
        expected[:, k] = GAINS["kp"] * error[:, k] + GAINS["kd"] * (dq_ref[:, k] - dq) + integral
    np.testing.assert_allclose(log.tau_true, expected, rtol=0.0, atol=1e-9)


def test_torque_stays_within_its_limit() -> None:
    robot = adjusted("scara2")
    robot = replace(robot, joints=tuple(replace(j, torque_limit=2.0) for j in robot.joints))
    log = push(closed_loop(robot, **GAINS), 100)
    np.testing.assert_array_equal(log.tau_true, 2.0)


def test_unstable_loop_is_reported_where_it_diverges() -> None:
    loop = closed_loop(adjusted("scara2"), kp=-GAINS["kp"], kd=-GAINS["kd"])
    wanted = reference(2, 20000)
    with pytest.raises(DivergedError) as diverged:
        loop.step(loop.init(np.zeros(2)), *wanted)
    tick = diverged.value.tick
    assert 0 < tick < 20000
    _, log = loop.step(loop.init(np.zeros(2)), *(signal[:, :tick] for signal in wanted))
    assert 1e3 < np.abs(log.dq_true).max() < np.inf


def test_encoder_reads_the_nearest_multiple_of_its_resolution() -> None:
    resolution = np.array([1e-3, 2e-3])
    loop = closed_loop(adjusted("scara2"), **GAINS, encoder_resolution=resolution)
    _, log = loop.step(loop.init(np.zeros(2)), *reference(2, 2000))
    nearest = resolution[:, None] * np.round(log.q_true / resolution[:, None])
    np.testing.assert_allclose(log.q, nearest, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("steps", [-1.5, -0.5, 0.0, 0.3, 0.5, 1.5, 2.5])
def test_loop_starts_without_a_jump_in_velocity(steps: float) -> None:
    """Half-way between two readings the controller and the encoder have to round alike."""
    loop = closed_loop(adjusted("emps"), kd=np.array([1.0]), encoder_resolution=np.array([0.25]))
    nothing = np.zeros((1, 1))
    _, log = loop.step(loop.init(np.array([0.25 * steps])), nothing, nothing, nothing)
    assert log.tau_true[0, 0] == 0.0


NOISY = closed_loop(
    adjusted("scara2"),
    **GAINS,
    velocity_cutoff=20.0,
    encoder_resolution=np.array([1e-4, 1e-4]),
    position_noise=np.array([1e-4, 2e-4]),
    torque_noise=np.array([0.2, 0.01]),
)


def run(loop: ClosedLoop, ticks: int, chunks: list[slice] | None = None) -> Array:
    """The whole log, (signals, joints, ticks), run chunk by chunk."""
    wanted = reference(2, ticks)
    state, logs = loop.init(np.zeros(2)), []
    for chunk in chunks or [slice(0, ticks)]:
        state, log = loop.step(state, *(signal[:, chunk] for signal in wanted))
        logs.append(np.array(list(vars(log).values())))
    return np.concatenate(logs, axis=2)


@given(chunks=cuts(60))
@settings(max_examples=30, deadline=None)
def test_chunks_do_not_change_a_bit(chunks: list[slice]) -> None:
    np.testing.assert_array_equal(run(NOISY, 60, chunks), run(NOISY, 60))


def test_step_leaves_its_state_alone() -> None:
    """Its sources of noise included."""
    state = NOISY.init(np.zeros(2))
    first, second = (NOISY.step(state, *reference(2, 60))[1] for _ in range(2))
    np.testing.assert_array_equal(first.tau, second.tau)
    np.testing.assert_array_equal(first.q, second.q)


def test_noise_is_that_of_the_seed() -> None:
    first, same, other = (run(replace(NOISY, seed=seed), 60) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, same)
    q, tau = first[:2] != other[:2]
    assert q.any()
    assert tau.any()


def test_noise_has_the_size_it_is_given() -> None:
    loop = replace(NOISY, encoder_resolution=np.zeros(2))
    ticks = 20000
    q, tau, q_true, _, _, tau_true, *_ = run(loop, ticks)
    # The standard deviation of a sample deviates by 1 / sqrt(2 n), 0.5 %; four times that.
    np.testing.assert_allclose((q - q_true).std(axis=1), loop.position_noise, rtol=0.02)
    np.testing.assert_allclose((tau - tau_true).std(axis=1), loop.torque_noise, rtol=0.02)


@pytest.mark.parametrize(
    ("settings", "complaint"),
    [
        ({"control_rate": 0.0}, "control rate"),
        ({"control_rate": np.nan}, "control rate"),
        ({"substeps": 0}, "substeps"),
        ({"position_noise": np.array([0.0, -1.0])}, "position noise must not be negative"),
        ({"torque_noise": np.array([-1.0, 0.0])}, "torque noise must not be negative"),
        ({"encoder_resolution": np.array([-1.0, 0.0])}, "encoder resolution must not be negative"),
    ],
)
def test_setting_without_sense_is_refused(settings: dict[str, Any], complaint: str) -> None:
    with pytest.raises(UsageFault, match=complaint):
        closed_loop(SMOOTH, **settings)


def test_robot_without_inertia_is_refused() -> None:
    """The second joint of this description has no mass at all."""
    scara = load("scara2")
    two_axes = replace(load("emps"), joints=scara.joints)
    loop = closed_loop(two_axes)
    with pytest.raises(IndefiniteError):
        loop.step(loop.init(np.zeros(2)), *reference(2, 1))
