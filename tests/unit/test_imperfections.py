"""Each imperfection of the simulated robot against a closed form or another integrator."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from unit.arms import described_arm, seven_axes, sines
from unit.plants import RATE, closed_loop, free, moving, push, pushed, reference
from unit.support import adjusted

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.imperfections import Payload, PlantImperfections
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

AXIS = adjusted("emps", Fv=0.0, offset=0.0)
MASS, COULOMB = AXIS.value("mass", 1), AXIS.value("coulomb", 1)
T = np.arange(2000) / RATE
SWING = np.array([0.5, -0.4, 0.8, 0.6, -0.7, 0.9, 0.3])
TERMS = "[[joint]]\nterms = { inertia = 0.1, viscous = 0.2, coulomb = 0.3 }\n"


def seven(folder: Path, terms: str = TERMS) -> Robot:
    (folder / "seven.urdf").write_text(seven_axes())
    return described_arm("seven.urdf", folder, 7 * terms)


def tracked(robot: Robot, ticks: int = 1500, **imperfections: Any) -> LoopLog:
    """A robot that follows sines by computed torque, whose model is that of the description."""
    found = law(robot, "computed-torque")
    loop = closed_loop(
        replace(robot, joints=tuple(replace(j, torque_limit=np.inf) for j in robot.joints)),
        kp=found.kp,
        kd=found.kd,
        kind=found.kind,
        imperfections=PlantImperfections(**imperfections),
    )
    wanted = reference(len(robot.joints), ticks)
    return loop.step(loop.init(wanted[0][:, 0]), *wanted)[1]


def rigid(robot: Robot, log: LoopLog) -> Array:
    """The torques of the links and motors, without friction and offset."""
    names = ("viscous", "coulomb", "offset")
    theta = [0.0 if p.term.NAME.startswith(names) else p.apriori for p in robot.parameters]
    W = robot.regressor(log.q_true, log.dq_true, log.ddq_true)
    return robot.torques(W, np.array(theta))


def test_drive_of_limited_bandwidth_lags_and_breaks_away_when_it_gets_there() -> None:
    """The torque rises as u (1 - exp(-w t)); friction is passed at t*, within a step."""
    u, omega = 1.5 * COULOMB, 2.0 * np.pi * 3.0
    loop = replace(pushed(AXIS, u), imperfections=PlantImperfections(drive_bandwidth=3.0))
    log = push(loop, len(T))
    np.testing.assert_allclose(log.tau_true[0], u * (1.0 - np.exp(-omega * T)), rtol=1e-12)
    np.testing.assert_array_equal(log.tau[0], u)
    start = -np.log(1.0 - COULOMB / u) / omega
    s = np.maximum(T - start, 0.0)
    left = (u - COULOMB) * (1.0 - np.exp(-omega * s))  # (u - C) = u exp(-w t*)
    np.testing.assert_allclose(log.ddq_true[0], left / MASS * (start < T), rtol=1e-9, atol=1e-12)
    v = (u - COULOMB) / MASS * (s - (1.0 - np.exp(-omega * s)) / omega)
    np.testing.assert_allclose(log.dq_true[0], v, rtol=1e-9, atol=1e-13)


def test_actual_torque_differs_by_the_gain_and_the_ripple_of_the_motor(tmp_path: Path) -> None:
    robot = seven(tmp_path)
    log = tracked(robot, motor_gain=np.linspace(-0.1, 0.1, 7), ripple=0.4, ripple_cycles=5.0)
    gain = 1.0 + np.linspace(-0.1, 0.1, 7)[:, None]
    expected = gain * log.tau + 0.4 * np.sin(2.0 * np.pi * 5.0 * log.q_true)
    np.testing.assert_allclose(log.tau_true, expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(rigid(robot, log) + log.friction_true, log.tau_true, atol=1e-11)


def friction_of(dq: Array, **given: Any) -> Array:
    """Friction by its equation, of joints with viscous friction 0.2 and Coulomb friction 0.3."""
    scale = 1.0 + given.get("friction_drift", 0.0) * (1.0 - np.exp(-T[: dq.shape[1]] / 0.5))
    jump = 0.3 * (1.0 + given.get("friction_asymmetry", 0.0) * np.sign(dq))
    jump = jump + given.get("stribeck", 0.0) * np.exp(-((dq / 0.2) ** 2))
    return np.asarray(scale * (0.2 * dq + np.sign(dq) * jump))


@pytest.mark.parametrize(
    "given",
    [
        {"stribeck": 0.25, "stribeck_velocity": 0.2},
        {"friction_asymmetry": -0.3},
        {"friction_drift": -0.4, "friction_drift_time": 0.5},
        {"load_friction": 0.1},
    ],
    ids=lambda given: next(iter(given)),
)
def test_friction_is_that_of_its_equation(given: dict[str, float], tmp_path: Path) -> None:
    robot = seven(tmp_path)
    log = tracked(robot, **given)
    transmitted = rigid(robot, log)
    np.testing.assert_allclose(transmitted + log.friction_true, log.tau_true, atol=1e-11)
    expected = friction_of(log.dq_true, **given)
    expected += given.get("load_friction", 0.0) * np.abs(transmitted) * np.sign(log.dq_true)
    slides = log.dq_true != 0.0
    assert slides.mean() > 0.95
    np.testing.assert_allclose(log.friction_true[slides], expected[slides], atol=1e-11)


@pytest.mark.parametrize("excess", [-1e-9, 1e-9])
@pytest.mark.parametrize(
    ("given", "breakaway"),
    [
        ({"stribeck": 0.3 * COULOMB}, 1.3 * COULOMB),
        ({"friction_asymmetry": 0.2}, 1.2 * COULOMB),
        ({"load_friction": 0.25}, COULOMB),  # an axis that friction holds transmits nothing
    ],
    ids=["stribeck", "asymmetry", "load"],
)
def test_joint_breaks_away_beyond_its_friction_at_rest(
    given: dict[str, float], breakaway: float, excess: float
) -> None:
    torque = (1.0 + excess) * breakaway
    log = push(replace(pushed(AXIS, torque), imperfections=PlantImperfections(**given)), 50)
    assert (log.dq_true[0, -1] != 0.0) == (excess > 0.0)


def link(folder: Path, gravity: float = 0.0) -> Robot:
    """One link on a vertical or horizontal axis, 0.5 kg m2 with 0.1 kg m2 of its motor."""
    (folder / "one.urdf").write_text(
        '<robot name="one"><link name="base"/><joint name="a" type="revolute">'
        '<parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>'
        '<limit lower="-9" upper="9" effort="0" velocity="0"/></joint><link name="arm">'
        '<inertial><origin xyz="0 0 -0.5"/><mass value="1"/><inertia ixx="0.25" ixy="0" ixz="0" '
        'iyy="0.25" iyz="0" izz="0.01"/></inertial></link></robot>'
    )
    terms = "gravity = [0.0, 0.0, %g]\n[[joint]]\nterms = { viscous = 0.0 }\n" % -gravity
    return described_arm("one.urdf", folder, terms)


@pytest.mark.parametrize("excess", [-1e-9, 1e-9])
def test_load_friction_helps_to_hold_a_load(excess: float, tmp_path: Path) -> None:
    """Friction mu |g| and a torque of (1 - mu) g hold a link in gravity g."""
    gravity = 9.81 * 0.5 * np.sin(0.7)
    loop = pushed(link(tmp_path, gravity=9.81), (1.0 + excess) * 0.8 * gravity)
    loop = replace(loop, imperfections=PlantImperfections(load_friction=0.2))
    far, still = np.full((1, 50), 1e3), np.zeros((1, 50))
    log = loop.step(loop.init(np.array([0.7])), far, still, still)[1]
    assert (log.dq_true[0, -1] == 0.0) == (excess > 0.0)


def test_flexible_joint_is_two_inertias_with_a_spring(tmp_path: Path) -> None:
    """The motor has the stated share of the link's inertia, where the description has none."""
    robot = link(tmp_path)
    given = PlantImperfections(flexibility=4.0, flexibility_damping=0.1, motor_share=0.4)
    loop = replace(pushed(robot, 3.0), imperfections=given)
    log = push(loop, 1000)
    omega, body, motor = 2.0 * np.pi * 4.0, 0.5, 0.2
    row = np.array([-1.0, 1.0, -2.0 * 0.1 / omega, 2.0 * 0.1 / omega]) * omega**2 * body
    A = np.zeros((5, 5))  # link, motor, their velocities, 1
    A[:2, 2:4], A[2, :4], A[3, :4], A[3, 4] = np.eye(2), row / body, -row / motor, 3.0 / motor
    step, state = expm(A / RATE), np.array([0.0, 0.0, 0.0, 0.0, 1.0])
    for k in range(1000):
        found = (log.q_true, log.q_motor_true, log.dq_true, log.dq_motor_true)
        np.testing.assert_allclose([x[0, k] for x in found], state[:4], rtol=1e-9, atol=1e-9)
        state = step @ state


def test_link_oscillates_at_its_frequency_while_friction_holds_the_motor(tmp_path: Path) -> None:
    robot = link(tmp_path)
    given = PlantImperfections(flexibility=5.0, flexibility_damping=0.02, stribeck=1e4)
    loop = closed_loop(robot, imperfections=given)
    still = np.zeros((1, len(T)))
    log = loop.step(moving(loop.init(np.zeros(1)), 1.0), still, still, still)[1]
    omega = 2.0 * np.pi * 5.0
    damped = omega * np.sqrt(1.0 - 0.02**2)
    expected = np.exp(-0.02 * omega * T) * np.sin(damped * T) / damped
    np.testing.assert_allclose(log.q_true[0], expected, atol=1e-9)
    np.testing.assert_array_equal(log.q_motor_true, 0.0)


@pytest.mark.parametrize("side", ["motor", "link"])
def test_flexible_arm_starts_at_rest_where_its_encoders_say(side: str, tmp_path: Path) -> None:
    """Gravity twists the transmissions; the encoders see the motors or the links."""
    robot = link(tmp_path, gravity=9.81)
    given = PlantImperfections(flexibility=3.0, encoder_side=side)
    found = law(robot, "pd-gravity")
    loop = closed_loop(robot, kp=found.kp, kd=found.kd, kind="pd-gravity", imperfections=given)
    state = loop.init(np.array([0.7]))
    q, motor = state.motion[0]
    assert (motor if side == "motor" else q) == 0.7
    K = (2.0 * np.pi * 3.0) ** 2 * 0.5
    assert motor - q == pytest.approx(9.81 * 0.5 * np.sin(q) / K, rel=1e-9)
    still = np.zeros((1, 200))
    log = loop.step(state, np.full((1, 200), 0.7), still, still)[1]
    np.testing.assert_array_equal(log.q, log.q_motor_true if side == "motor" else log.q_true)
    assert np.abs(log.dq_true[:, 0]).max() == 0.0


def test_steps_too_long_for_a_stiff_joint_are_refused(tmp_path: Path) -> None:
    loop = closed_loop(link(tmp_path), imperfections=PlantImperfections(flexibility=2e3))
    with pytest.raises(UsageFault, match=r"too fast.*6 times as many --substeps"):
        loop.init(np.zeros(1))


def test_vibration_of_the_base_acts_like_gravity(tmp_path: Path) -> None:
    """A pendulum on a base that shakes, against another integrator."""
    robot = link(tmp_path, gravity=9.81)
    given = PlantImperfections(
        vibration=3.0, vibration_frequency=2.5, vibration_direction=(1.0, 0.0, 1.0)
    )
    log = free(closed_loop(robot, imperfections=given), [0.4], [0.0], len(T))

    def pendulum(t: float, state: Array) -> Array:
        a = 3.0 * np.sqrt(0.5) * np.sin(2.0 * np.pi * 2.5 * t)
        # The centre of mass hangs 0.5 m below: at (-0.5 sin q, -0.5 cos q) of x and z.
        torque = -0.5 * ((9.81 + a) * np.sin(state[0]) - a * np.cos(state[0]))
        return np.array([state[1], torque / 0.5])

    found = solve_ivp(pendulum, (0.0, T[-1]), [0.4, 0.0], "DOP853", T, rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(log.q_true[0], found.y[0], atol=1e-9)


def test_payload_is_part_of_the_last_link_from_its_time_on(tmp_path: Path) -> None:
    """The torques before and after are those of Pinocchio's models without and with the body."""
    robot = seven(tmp_path, "[[joint]]\nterms = { viscous = 0.2 }\n")
    centre, inertia = (0.02, -0.03, 0.12), (0.02, 0.001, 0.002, 0.03, -0.001, 0.025)
    payload = Payload(1.7, centre, inertia, start=0.6004)
    log = tracked(robot, 1000, payload=payload)
    assert robot.body
    loaded = robot.body.model.copy()
    xx, xy, xz, yy, yz, zz = inertia
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    body = pinocchio.Inertia(1.7, np.array(centre), own)
    loaded.appendBodyToJoint(7, body, pinocchio.SE3.Identity())
    for k in range(0, 1000, 7):
        model = loaded if k >= 601 else robot.body.model
        motion = (x[:, k].copy() for x in (log.q_true, log.dq_true, log.ddq_true))
        tau = pinocchio.rnea(model, model.createData(), *motion) + 0.2 * log.dq_true[:, k]
        np.testing.assert_allclose(log.tau_true[:, k], tau, atol=1e-11)


def test_all_imperfections_together_do_not_depend_on_chunks(tmp_path: Path) -> None:
    robot = seven(tmp_path)
    given = PlantImperfections(
        drive_bandwidth=40.0,
        motor_gain=0.03,
        ripple=0.1,
        ripple_cycles=8.0,
        stribeck=0.1,
        load_friction=0.05,
        friction_asymmetry=0.1,
        friction_drift=-0.2,
        flexibility=np.array([20.0, 20.0, 0.0, 15.0, 0.0, 0.0, 0.0]),
        vibration=0.5,
        vibration_frequency=7.0,
        payload=Payload(0.5, start=0.05),
    )
    found = law(robot, "computed-torque", 2.0)
    loop = closed_loop(robot, kp=found.kp, kd=found.kd, kind=found.kind, imperfections=given)
    wanted = sines(7, 120, 0.3, 1)
    start = wanted[0][:, 0]
    whole = np.array(list(vars(loop.step(loop.init(start), *wanted)[1]).values()))
    state, parts = loop.init(start), []
    for chunk in (slice(0, 1), slice(1, 40), slice(40, 60), slice(60, 120)):
        state, log = loop.step(state, *(x[:, chunk] for x in wanted))
        parts.append(np.array(list(vars(log).values())))
    np.testing.assert_array_equal(np.concatenate(parts, axis=2), whole)


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"ripple": -1.0}, "ripple must not be negative"),
        ({"stribeck_velocity": 0.0}, "stribeck velocity must be positive"),
        ({"motor_gain": -1.5}, "motor gain must not be below -1"),
        ({"drive_bandwidth": np.inf}, "drive bandwidth must not be negative, and finite"),
        ({"encoder_side": "tool"}, "choose motor or link"),
        ({"load_friction": 1.0}, "load friction must be below 1"),
        ({"vibration": 1.0, "vibration_direction": (0.0, 0.0, 0.0)}, "direction must not be zero"),
    ],
)
def test_imperfection_without_sense_is_refused(given: dict[str, Any], complaint: str) -> None:
    with pytest.raises(UsageFault, match=complaint):
        closed_loop(AXIS, imperfections=PlantImperfections(**given)).init(np.zeros(1))
