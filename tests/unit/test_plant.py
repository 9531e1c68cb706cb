"""The simulated robot against mechanics: energy, a reference integrator, dry friction."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.integrate import solve_ivp
from unit.support import adjusted, cuts

from scarid_cli.algorithms.plants.loop import ClosedLoop, DivergedError, LoopLog, LoopState
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.kernels import plant

RATE = 1000.0
GAINS = {"kp": np.array([800.0, 25.0]), "kd": np.array([100.0, 2.5])}


def closed_loop(robot: Robot, **settings: Any) -> ClosedLoop:
    """No control, no noise and a perfect encoder, unless told."""
    none = np.zeros(len(robot.joints))
    names = ("kp", "kd", "ki", "encoder_resolution", "position_noise", "torque_noise")
    fixed = {"velocity_cutoff": 0.0, "seed": 0, "control_rate": RATE}
    return ClosedLoop(robot, **(dict.fromkeys(names, none) | fixed | settings))


def moving(state: LoopState, *dq: float) -> LoopState:
    """The same state, with velocities."""
    values = state.values.copy()
    values[2 : 2 + len(dq)] = dq
    return replace(state, values=values)


def free(loop: ClosedLoop, q: list[float], dq: list[float], ticks: int) -> LoopLog:
    """What happens without a reference."""
    nothing = np.zeros((len(q), ticks))
    return loop.step(moving(loop.init(np.array(q)), *dq), nothing, nothing)[1]


def pushed(robot: Robot, *torques: float) -> ClosedLoop:
    """A robot whose torques are constant: whatever its error, they are at their limits."""
    joints = [
        replace(joint, torque_limit=torque)
        for joint, torque in zip(robot.joints, torques, strict=True)
    ]
    return closed_loop(replace(robot, joints=tuple(joints)), kp=np.full(len(joints), 1e12))


def push(loop: ClosedLoop, ticks: int) -> LoopLog:
    """From rest at zero, all torques forwards."""
    joints = len(loop.robot.joints)
    far, still = np.full((joints, ticks), 1e3), np.zeros((joints, ticks))
    return loop.step(loop.init(np.zeros(joints)), far, still)[1]


def reference(joints: int, ticks: int) -> tuple[Array, Array]:
    """Sines to follow: position and velocity."""
    t, omega = np.arange(ticks) / RATE, np.array([[2.0], [3.0]])[:joints]
    return 0.5 * np.sin(omega * t), 0.5 * omega * np.cos(omega * t)


def inertia(robot: Robot, q: Array) -> Array:
    """The inertia matrix of section A.1: (samples, 2, 2)."""
    zz1r, zz2, mx, my = (robot.value(term) for term in ("ZZ1R", "ZZ2", "L1MX2", "L1MY2"))
    coupling = mx * np.cos(q[1]) - my * np.sin(q[1])
    rows = [[zz1r + zz2 + 2.0 * coupling, zz2 + coupling], [zz2 + coupling, zz2 + 0.0 * coupling]]
    return np.moveaxis(np.array(rows), 2, 0)


SMOOTH = adjusted("scara2", Fv1=0.0, Fs1=0.0, Fv2=0.0, Fs2=0.0, L1MY2=0.03)


# Motion


@pytest.mark.parametrize("dq", [[1.0, 6.0], [-2.0, -9.0]])
def test_kinetic_energy_is_kept_without_friction_and_control(dq: list[float]) -> None:
    """Joint 2 turns over and over, and trades energy with joint 1."""
    log = free(closed_loop(SMOOTH), [0.0, 0.3], dq, 5000)
    M = inertia(SMOOTH, log.q_true)
    energy = 0.5 * np.einsum("ik,kij,jk->k", log.dq_true, M, log.dq_true)
    assert np.ptp(log.dq_true[1]) > 0.5
    np.testing.assert_allclose(energy, energy[0], rtol=1e-12)


def test_kinetic_energy_is_kept_when_a_joint_reverses() -> None:
    """Without dry friction nothing stops a joint on its way back."""
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
    """While all joints slide; a joint that sticks has a dry friction within its bounds."""
    robot = adjusted(name)
    joints = len(robot.joints)
    assert robot.control is not None
    gains = {key: np.array(getattr(robot.control, key)) for key in ("kp", "kd")}
    loop = closed_loop(robot, **gains, encoder_resolution=np.full(joints, 1e-7))
    _, log = loop.step(loop.init(np.zeros(joints)), *reference(joints, 4000))
    W = robot.regressor(log.q_true, log.dq_true, log.ddq_true)
    missing = log.tau_true - robot.torques(W, robot.apriori)
    at_rest = log.dq_true == 0.0
    dry = np.array([[robot.value("coulomb", joint)] for joint in range(1, joints + 1)])
    scale = np.abs(log.tau_true).max()
    assert np.abs(missing[~at_rest]).max() < 1e-12 * scale
    assert at_rest.any()
    assert np.all(
        np.abs(missing)[at_rest] <= np.broadcast_to(dry, missing.shape)[at_rest] + 1e-12 * scale
    )


# Dry friction

AXIS = adjusted("emps", Fv=0.0, offset=0.0)
MASS, COULOMB = AXIS.value("mass", 1), AXIS.value("coulomb", 1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_joint_stays_where_it_is_below_the_dry_friction(sign: float) -> None:
    loop = pushed(AXIS, 0.999 * COULOMB)
    _, log = loop.step(
        loop.init(np.array([0.1])), np.full((1, 3000), sign * 1e3), np.zeros((1, 3000))
    )
    np.testing.assert_array_equal(log.tau_true, sign * 0.999 * COULOMB)
    np.testing.assert_array_equal(log.q_true, 0.1)
    np.testing.assert_array_equal(log.dq_true, 0.0)
    np.testing.assert_array_equal(log.ddq_true, 0.0)


@pytest.mark.parametrize("excess", [0.001, 0.5])
def test_joint_accelerates_with_what_exceeds_the_dry_friction(excess: float) -> None:
    log = push(pushed(AXIS, (1.0 + excess) * COULOMB), 3000)
    t, ddq = np.arange(3000) / RATE, excess * COULOMB / MASS
    np.testing.assert_allclose(log.ddq_true[0], ddq, rtol=1e-10)
    np.testing.assert_allclose(log.q_true[0], 0.5 * ddq * t**2, rtol=1e-10)


@pytest.mark.parametrize("dq", [0.1, -0.37])
def test_sliding_joint_stops_where_friction_has_eaten_its_energy(dq: float) -> None:
    """After m v / Fc, at m v^2 / (2 Fc); there it stays."""
    log = free(closed_loop(AXIS), [0.0], [dq], 3000)
    stop = MASS * abs(dq) / COULOMB
    tick = int(np.argmax(log.dq_true[0] == 0.0))
    assert stop <= tick / RATE <= stop + 1.0 / RATE + 1.0 / (4.0 * RATE)
    np.testing.assert_array_equal(log.dq_true[0, tick:], 0.0)
    np.testing.assert_array_equal(log.q_true[0, tick:], log.q_true[0, tick])
    # It comes to rest somewhere in its last substep: a d^2 / 2 at the most.
    last = 0.5 * COULOMB / MASS / (4.0 * RATE) ** 2
    assert log.q_true[0, -1] == pytest.approx(np.sign(dq) * 0.5 * stop * abs(dq), abs=last)


@pytest.mark.parametrize(("share", "slides"), [(0.99, False), (1.01, True)])
def test_joint_at_rest_is_dragged_along_beyond_its_dry_friction(
    share: float, *, slides: bool
) -> None:
    """Joint 1 accelerates; M12 of its acceleration is what joint 2 has to hold."""
    robot = adjusted("scara2", Fv1=0.0, Fv2=0.0, Fs1=0.0)
    M = inertia(robot, np.zeros((2, 1)))[0]
    torque = share * robot.value("coulomb", 2) / M[1, 0] * M[0, 0]
    log = push(pushed(robot, torque, 0.0), 2)
    assert log.ddq_true[0, 0] > 0.0
    assert (log.ddq_true[1, 0] != 0.0) == slides


# Control


def test_torque_is_equation_29_on_what_the_encoder_says() -> None:
    """Worked out again from the log, with the smoothed backward difference for velocity."""
    robot = adjusted("scara2")
    ki, cutoff = np.array([5.0, 0.5]), 20.0
    loop = closed_loop(
        robot, **GAINS, ki=ki, velocity_cutoff=cutoff, encoder_resolution=np.full(2, 1e-4)
    )
    q_ref, dq_ref = reference(2, 1000)
    _, log = loop.step(loop.init(np.zeros(2)), q_ref, dq_ref)
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
    q_ref, dq_ref = reference(2, 20000)
    with pytest.raises(DivergedError) as diverged:
        loop.step(loop.init(np.zeros(2)), q_ref, dq_ref)
    tick = diverged.value.tick
    assert 0 < tick < 20000
    _, log = loop.step(loop.init(np.zeros(2)), q_ref[:, :tick], dq_ref[:, :tick])
    assert 1e3 < np.abs(log.dq_true).max() < np.inf


# Encoder and noise


def test_encoder_reads_the_nearest_multiple_of_its_resolution() -> None:
    resolution = np.array([1e-3, 2e-3])
    loop = closed_loop(adjusted("scara2"), **GAINS, encoder_resolution=resolution)
    _, log = loop.step(loop.init(np.zeros(2)), *reference(2, 2000))
    nearest = resolution[:, None] * np.round(log.q_true / resolution[:, None])
    np.testing.assert_allclose(log.q, nearest, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("steps", [-1.5, -0.5, 0.0, 0.3, 0.5, 1.5, 2.5])
def test_loop_starts_without_a_jump_in_velocity(steps: float) -> None:
    """Half-way between two readings the controller and the encoder have to round alike."""
    loop = closed_loop(AXIS, kd=np.array([1.0]), encoder_resolution=np.array([0.25]))
    nothing = np.zeros((1, 1))
    _, log = loop.step(loop.init(np.array([0.25 * steps])), nothing, nothing)
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
    q_ref, dq_ref = reference(2, ticks)
    state, logs = loop.init(np.zeros(2)), []
    for chunk in chunks or [slice(0, ticks)]:
        state, log = loop.step(state, q_ref[:, chunk], dq_ref[:, chunk])
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
    q, tau, q_true, _, _, tau_true = run(loop, ticks)
    # The standard deviation of a sample deviates by 1 / sqrt(2 n), 0.5 %; four times that.
    np.testing.assert_allclose((q - q_true).std(axis=1), loop.position_noise, rtol=0.02)
    np.testing.assert_allclose((tau - tau_true).std(axis=1), loop.torque_noise, rtol=0.02)


# What cannot be simulated


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


def test_robot_of_another_kind_is_refused() -> None:
    scara = load("scara2")
    two_axes = replace(load("emps"), joints=scara.joints)
    loop = closed_loop(two_axes)
    with pytest.raises(UsageFault, match="only one axis"):
        loop.step(loop.init(np.zeros(2)), *reference(2, 1))


ARM = [3.42, 0.064, 0.131, 0.03]


def coast(model: list[float], q: list[float], dq: list[float], ticks: int) -> Array:
    """The log without control, at 1 kHz."""
    state, log = np.array([*q, *dq, *q, *np.zeros(4)]), np.empty((ticks, 10))
    control = np.array([0.0] * 6 + [1e300] * 2 + [0.0] * 3)
    reference, noise = np.zeros((ticks, 4)), np.zeros((ticks, 2))
    assert plant.run(reference, noise, log, state, np.array(model), control, 1e-3, 4) == ticks
    return log


def mass_matrix(q2: Any) -> Array:
    zz1r, zz2, mx, my = ARM
    coupling = mx * np.cos(q2) - my * np.sin(q2)
    return np.array([[zz1r + zz2 + 2.0 * coupling, zz2 + coupling], [zz2 + coupling, zz2]])


@pytest.mark.parametrize("dq", [[1.0, 6.0], [-2.0, -9.0], [2.0, 1.0]])
def test_momentum_of_joint_1_is_kept_without_friction_and_control(dq: list[float]) -> None:
    """The kinetic energy does not depend on q1."""
    log = coast([*ARM, *np.zeros(6)], [0.0, 0.3], dq, 5000)
    coupled = mass_matrix(0.0)[1, 1] + ARM[2] * np.cos(log[:, 5]) - ARM[3] * np.sin(log[:, 5])
    momentum = (ARM[0] - ARM[1] + 2.0 * coupled) * log[:, 6] + coupled * log[:, 7]
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-12)


def test_viscous_coasting_agrees_with_a_reference_integrator() -> None:
    viscous = np.array([0.7, 0.015])

    def motion(_: float, state: Array) -> Array:
        v, bend = state[2:], ARM[2] * np.sin(state[1]) + ARM[3] * np.cos(state[1])
        coriolis = np.array([-bend * v[1] * (2.0 * v[0] + v[1]), bend * v[0] ** 2])
        return np.concatenate((v, np.linalg.solve(mass_matrix(state[1]), -coriolis - viscous * v)))

    start, t = [0.0, 0.3, 2.0, -4.0], np.arange(3000) / 1000.0
    expected = solve_ivp(motion, (0.0, 3.0), start, "DOP853", t, rtol=1e-11, atol=1e-13).y
    log = coast([*ARM, *viscous, *np.zeros(4)], start[:2], start[2:], 3000)
    assert np.ptp(np.sign(log[:, 7])) == 2.0  # joint 2 reverses on its way
    np.testing.assert_allclose(log[:, 4:8].T, expected, atol=1e-9)  # (0.25 ms)^4 = 4e-15 a second


def complementary(q2: float, tau: Array, dry: Array) -> Array:
    """The accelerations from rest, by trying all nine ways to stick and slide: one is right."""
    M, found = mass_matrix(q2), []
    for way in itertools.product((-1.0, 0.0, 1.0), repeat=2):
        s, a = np.array(way), np.zeros(2)
        slides = np.flatnonzero(s)
        if len(slides):
            a[slides] = np.linalg.solve(M[np.ix_(slides, slides)], (tau - dry * s)[slides])
        holding = tau - M @ a
        if np.all(np.where(s == 0.0, np.abs(holding) <= dry, a * s > 0.0)):
            found.append(a)
    assert len(found) == 1
    return found[0]


def test_both_joints_leave_rest_as_complementarity_says() -> None:
    rng = np.random.default_rng(0)
    dry = np.array([0.58, 0.156])
    for _ in range(300):
        q2, tau = rng.uniform(-1.5, 1.5), rng.uniform(-1.0, 1.0, 2) * [3.0, 0.8]
        model = np.array([*ARM, 0.0, 0.0, *dry, 0.0, 0.0])
        state = np.array([0.0, q2, 0.0, 0.0, 0.0, q2, *np.zeros(4)])
        reference = np.array([[*(np.sign(tau) * 1e6), 0.0, 0.0]])
        control = np.array([1e9, 1e9, 0.0, 0.0, 0.0, 0.0, *np.abs(tau), 0.0, 0.0, 0.0])
        log = np.empty((1, 10))
        plant.run(reference, np.zeros((1, 2)), log, state, model, control, 1e-3, 4)
        np.testing.assert_allclose(log[0, 2:4], tau)
        np.testing.assert_allclose(log[0, 8:10], complementary(q2, tau, dry), atol=1e-10)
