"""The motion of the simulated robot: energy, momentum, a reference integrator."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from unit.plants import (
    ARM,
    RATE,
    SMOOTH,
    closed_loop,
    free,
    inertia,
    mass_matrix,
    push,
    pushed,
    reference,
)
from unit.support import adjusted

from scarid_cli.arrays import Array


@pytest.mark.parametrize("dq", [[1.0, 6.0], [-2.0, -9.0]])
def test_kinetic_energy_is_kept_without_friction_and_control(dq: list[float]) -> None:
    """Joint 2 turns over and over, and trades energy with joint 1."""
    log = free(closed_loop(SMOOTH), [0.0, 0.3], dq, 5000)
    M = inertia(SMOOTH, log.q_true)
    energy = 0.5 * np.einsum("ik,kij,jk->k", log.dq_true, M, log.dq_true)
    assert np.ptp(log.dq_true[1]) > 0.5
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)


def test_kinetic_energy_is_kept_when_a_joint_reverses() -> None:
    """Without Coulomb friction nothing stops a joint on its way back."""
    log = free(closed_loop(SMOOTH), [0.0, 0.3], [2.0, 1.0], 5000)
    M = inertia(SMOOTH, log.q_true)
    energy = 0.5 * np.einsum("ik,kij,jk->k", log.dq_true, M, log.dq_true)
    assert np.any(log.dq_true[1] < 0.0)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)


def test_motion_agrees_with_a_reference_integrator() -> None:
    robot, torques = adjusted("scara2", Fs1=0.0, Fs2=0.0, Fv1=0.7), np.array([3.0, 0.4])
    viscous = np.array([0.7, 0.015])

    def motion(_: float, state: Array) -> Array:
        q, v = state[:2], state[2:]
        s = robot.value("L1MX2") * np.sin(q[1])
        coriolis = np.array([-s * v[1] * (2.0 * v[0] + v[1]), s * v[0] ** 2])
        M = inertia(robot, q[:, None])[0]
        return np.concatenate((v, np.linalg.solve(M, torques - coriolis - viscous * v)))

    ticks = 2000
    log = push(pushed(robot, *torques), ticks)
    expected = solve_ivp(
        motion,
        (0.0, ticks / RATE),
        np.zeros(4),
        "DOP853",
        np.arange(ticks) / RATE,
        rtol=1e-13,
        atol=1e-14,
    ).y
    assert np.all(log.dq_true[:, 1:] > 0.0)  # no reversal, no sticking
    # Both integrators are of a high order with small steps: what is left is near rounding.
    np.testing.assert_allclose(log.q_true, expected[:2], rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(log.dq_true, expected[2:], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("name", ["scara2", "emps"])
def test_logged_motion_and_torques_obey_the_inverse_dynamics(name: str) -> None:
    """While all joints slide; a joint that sticks has a Coulomb friction within its bounds."""
    robot = adjusted(name)
    joints = len(robot.joints)
    assert robot.control is not None
    gains = {key: np.array(getattr(robot.control, key)) for key in ("kp", "kd")}
    loop = closed_loop(robot, **gains, encoder_resolution=np.full(joints, 1e-7))
    _, log = loop.step(loop.init(np.zeros(joints)), *reference(joints, 4000))
    W = robot.regressor(log.q_true, log.dq_true, log.ddq_true)
    missing = log.tau_true - robot.torques(W, robot.apriori)
    at_rest = log.dq_true == 0.0
    coulomb = np.array([[robot.value("coulomb", joint)] for joint in range(1, joints + 1)])
    scale = np.abs(log.tau_true).max()
    assert np.abs(missing[~at_rest]).max() < 1e-12 * scale
    assert at_rest.any()
    assert np.all(
        np.abs(missing)[at_rest] <= np.broadcast_to(coulomb, missing.shape)[at_rest] + 1e-12 * scale
    )


@pytest.mark.parametrize("dq", [[1.0, 6.0], [-2.0, -9.0], [2.0, 1.0]])
def test_momentum_of_joint_1_is_kept_without_friction_and_control(dq: list[float]) -> None:
    """The kinetic energy does not depend on q1."""
    log = free(closed_loop(SMOOTH), [0.0, 0.3], dq, 5000)
    M = inertia(SMOOTH, log.q_true)
    momentum = M[:, 0, 0] * log.dq_true[0] + M[:, 0, 1] * log.dq_true[1]
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-12)


def test_viscous_coasting_agrees_with_a_reference_integrator() -> None:
    viscous = np.array([0.7, 0.015])

    def motion(_: float, state: Array) -> Array:
        v, bend = state[2:], ARM[2] * np.sin(state[1]) + ARM[3] * np.cos(state[1])
        coriolis = np.array([-bend * v[1] * (2.0 * v[0] + v[1]), bend * v[0] ** 2])
        return np.concatenate((v, np.linalg.solve(mass_matrix(state[1]), -coriolis - viscous * v)))

    start, t = [0.0, 0.3, 2.0, -4.0], np.arange(3000) / 1000.0
    expected = solve_ivp(motion, (0.0, 3.0), start, "DOP853", t, rtol=1e-11, atol=1e-13).y
    robot = adjusted("scara2", Fv1=viscous[0], Fv2=viscous[1], Fs1=0.0, Fs2=0.0, L1MY2=ARM[3])
    log = free(closed_loop(robot), start[:2], start[2:], 3000)
    assert np.ptp(np.sign(log.dq_true[1])) == 2.0  # joint 2 reverses on its way
    np.testing.assert_allclose(np.concatenate((log.q_true, log.dq_true)), expected, atol=1e-9)
