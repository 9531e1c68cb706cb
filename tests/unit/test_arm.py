"""The motion of simulated arms: torques, accuracy, energy, sticking, for any chain and friction."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from unit.arms import URDF, described_arm, seven_axes
from unit.plants import closed_loop, free, moving, pushed, reference

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.terms import Stribeck
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

DIRECTED = "{ inertia = 0.2, viscous-forward = 0.3, viscous-backward = 0.4, %s }"
ONE_WAY = DIRECTED % "coulomb-forward = 0.7, coulomb-backward = 0.4"
BOTH_WAYS = "{ inertia = 0.1, viscous = 0.2, coulomb = 0.5, offset = 0.1 }"


def two_axes(folder: Path, kind: str = "revolute", coupling: str = "") -> Robot:
    """An arm of two axes whose frictions are all different."""
    (folder / "two.urdf").write_text(URDF.replace("TYPE", kind))
    lines = f"[[joint]]\nterms = {ONE_WAY}\n[[joint]]\nterms = {BOTH_WAYS}\n{coupling}"
    return described_arm("two.urdf", folder, lines)


def coupled(folder: Path) -> Robot:
    """Two axes, where the motor of the second turns with both."""
    robot = two_axes(folder, coupling="[[coupling]]\njoints = [1, 2]\nratio = 0.7\n")
    values = {"coupled-inertia": 0.05, "coupled-viscous": 0.06, "coupled-coulomb": 0.3}
    return replace(
        robot,
        parameters=tuple(
            replace(p, apriori=values.get(p.term.NAME, p.apriori)) for p in robot.parameters
        ),
    )


def stribeck(_: Path) -> Robot:
    """The planar arm with Stribeck friction at both joints."""
    robot = load("scara2").with_stribeck({1: 0.3, 2: 0.2})
    parameters = (
        replace(p, apriori=0.1) if isinstance(p.term, Stribeck) else p for p in robot.parameters
    )
    return replace(robot, parameters=tuple(parameters))


def seven(folder: Path) -> Robot:
    (folder / "seven.urdf").write_text(seven_axes())
    terms = "\n".join(["[[joint]]\nterms = { viscous = 0.2, coulomb = 0.3 }"] * 7)
    return described_arm("seven.urdf", folder, terms)


ARMS: dict[str, Callable[[Path], Robot]] = {
    "revolute": two_axes,
    "prismatic": lambda folder: two_axes(folder, "prismatic"),
    "coupled": coupled,
    "Stribeck": stribeck,
    "smoothed": lambda _: load("scara2").smoothed(0.05),
    "gravity": lambda _: load("planar2-gravity"),
    "seven axes": seven,
}


def tracked(robot: Robot, ticks: int = 3000) -> LoopLog:
    """A robot that follows sines and comes to rest now and then."""
    found = law(robot, "computed-torque")
    gains = {"kp": found.kp, "kd": found.kd, "kind": found.kind}
    limits = tuple(replace(joint, torque_limit=np.inf) for joint in robot.joints)
    loop = closed_loop(replace(robot, joints=limits), **gains)
    return loop.step(loop.init(np.zeros(len(robot.joints))), *reference(len(limits), ticks))[1]


@pytest.mark.parametrize("name", ARMS)
def test_torques_are_those_of_the_regressor_while_all_joints_slide(
    name: str, tmp_path: Path
) -> None:
    robot = ARMS[name](tmp_path)
    log = tracked(robot)
    W = robot.regressor(log.q_true, log.dq_true, log.ddq_true)
    missing = np.abs(log.tau_true - robot.torques(W, robot.apriori)).max(axis=0)
    slides = np.all(log.dq_true != 0.0, axis=0)
    if name == "coupled":
        slides &= np.abs(0.7 * log.dq_true[0] + log.dq_true[1]) > 1e-12
    assert missing[slides].max() < 1e-13 * np.abs(log.tau_true).max()
    assert slides.mean() > 0.9
    assert np.all(np.ptp(np.sign(log.dq_true), axis=1) == 2.0)  # all joints reverse


def test_friction_is_what_the_motion_leaves_of_the_torque(tmp_path: Path) -> None:
    """Also where a joint is at rest: there it is within the Coulomb friction."""
    robot = two_axes(tmp_path)
    log = tracked(robot)
    names = ("viscous", "coulomb", "offset")
    theta = [0.0 if p.term.NAME.startswith(names) else p.apriori for p in robot.parameters]
    W = robot.regressor(log.q_true, log.dq_true, log.ddq_true)
    rigid = robot.torques(W, np.array(theta))
    np.testing.assert_allclose(rigid + log.friction_true, log.tau_true, atol=1e-12)
    rest = log.dq_true[0] == 0.0
    assert rest.sum() > 0
    held = log.friction_true[0, rest]
    assert np.all((held <= 0.7) & (held >= -0.4))


SWING = [0.5, -0.4, 0.8, 0.6, -0.7, 0.9, 0.3]


@pytest.mark.parametrize("coulomb", [0.0, 0.1])
def test_errors_fall_with_the_fourth_power_of_the_step(coulomb: float, tmp_path: Path) -> None:
    """Stops included, because steps end there: otherwise it would be the first or second power."""
    (tmp_path / "seven.urdf").write_text(seven_axes())
    terms = f"[[joint]]\nterms = {{ viscous = 0.3, coulomb = {coulomb} }}\n"
    robot = described_arm("seven.urdf", tmp_path, 7 * terms)
    ends = {}
    for substeps in (16, 32, 256):
        loop = closed_loop(robot, control_rate=20.0, substeps=substeps)
        still = np.zeros((7, 60))
        state = moving(loop.init(np.array(SWING)), *SWING)
        state, log = loop.step(state, still, still, still)
        ends[substeps] = state.motion[0]
    assert np.any(log.dq_true == 0.0) == (coulomb > 0.0)
    errors = [np.linalg.norm(ends[n] - ends[256]) for n in (16, 32)]
    assert 3.5 < np.log2(errors[0] / errors[1]) < 4.6
    assert errors[1] < 1e-4


def test_energy_is_that_of_the_torques_less_friction(tmp_path: Path) -> None:
    """A held torque does the work tau dq of each tick, Coulomb friction C |dq| if none reverses."""
    (tmp_path / "seven.urdf").write_text(seven_axes())
    terms = "[[joint]]\nterms = { coulomb = 0.2 }\n"
    robot = described_arm("seven.urdf", tmp_path, 7 * terms)
    log = tracked(robot)
    assert robot.body
    model = robot.body.model
    data = model.createData()
    energy = np.array(
        [
            pinocchio.computeKineticEnergy(model, data, q, v)
            + pinocchio.computePotentialEnergy(model, data, q)
            for q, v in zip(log.q_true.T, log.dq_true.T, strict=True)
        ]
    )
    moved = np.diff(log.q_true, axis=1)
    work = (log.tau_true[:, :-1] * moved).sum(axis=0)
    friction = 0.2 * np.abs(moved).sum(axis=0)
    kept = np.all(np.sign(log.dq_true[:, 1:]) == np.sign(log.dq_true[:, :-1]), axis=0)
    assert kept.mean() > 0.9
    missing = np.diff(energy) - (work - friction)
    assert np.abs(missing[kept]).max() < 1e-10 * np.ptp(energy)


def test_arm_that_friction_holds_does_not_creep(tmp_path: Path) -> None:
    (tmp_path / "seven.urdf").write_text(seven_axes())
    robot = described_arm("seven.urdf", tmp_path, 7 * "[[joint]]\nterms = { coulomb = 300.0 }\n")
    log = free(closed_loop(robot), SWING, [0.0] * 7, 2000)
    np.testing.assert_array_equal(log.q_true, np.array(SWING)[:, None] + np.zeros(2000))
    np.testing.assert_array_equal(log.dq_true, 0.0)


SLIPS = np.array([[1.0, 0.0], [0.0, 1.0], [0.7, 1.0]])  # of both joints and their coupling
FORWARD, BACKWARD = np.array([0.7, 0.5, 0.3]), np.array([0.4, 0.5, 0.3])


def held_by(robot: Robot, tau: Array) -> Array:
    """The accelerations from rest: the least of Gauss's function with friction, which is convex.

    It is quadratic for given directions of all slips; the least of all these minima is the least.
    """
    zero = np.zeros((2, 1))
    rest = robot.torques(robot.regressor(zero, zero, zero), robot.apriori)[:, 0]
    steps = [robot.regressor(zero, zero, np.eye(2)[:, [i]]) for i in range(2)]
    M = np.array([robot.torques(W, robot.apriori)[:, 0] - rest for W in steps])

    def cost(a: Array) -> float:
        slip = SLIPS @ a
        friction = FORWARD @ np.maximum(slip, 0.0) + BACKWARD @ np.maximum(-slip, 0.0)
        return float(0.5 * a @ M @ a - (tau - rest) @ a + friction)

    candidates = []
    for way in itertools.product((-1.0, 0.0, 1.0), repeat=3):
        s = np.array(way)
        stuck = SLIPS[s == 0.0]
        force = tau - rest - np.where(s > 0.0, FORWARD, -BACKWARD) * (s != 0.0) @ SLIPS
        system = np.block([[M, stuck.T], [stuck, np.zeros((len(stuck), len(stuck)))]])
        right = np.concatenate((force, np.zeros(len(stuck))))
        candidates.append(np.linalg.lstsq(system, right, rcond=None)[0][:2])
    return min(candidates, key=cost)


@pytest.mark.parametrize("seed", range(12))
def test_joints_and_their_coupling_leave_rest_as_gauss_says(seed: int, tmp_path: Path) -> None:
    """Three contacts of two joints: their forces are not unique, the accelerations are."""
    robot = coupled(tmp_path)
    tau = np.random.default_rng(seed).uniform([-4.0, -1.5], [12.0, 4.0])
    expected = held_by(robot, tau)
    loop = pushed(robot, *np.abs(tau))
    far, zero = 1e3 * np.sign(tau)[:, None], np.zeros((2, 1))
    log = loop.step(loop.init(np.zeros(2)), far, zero, zero)[1]
    np.testing.assert_allclose(log.ddq_true[:, 0], expected, atol=1e-9)


def test_two_couplings_of_one_joint_are_refused(tmp_path: Path) -> None:
    (tmp_path / "seven.urdf").write_text(seven_axes())
    pairs = "".join(f"[[coupling]]\njoints = {i}\nratio = 1.0\n" for i in ([5, 7], [7, 6]))
    axes = "".join(f"[[joint]]\nname = 'j{i}'\n" for i in range(1, 8))
    robot = described_arm("seven.urdf", tmp_path, axes + pairs)
    loop = closed_loop(robot)
    with pytest.raises(UsageFault, match="two couplings of one joint"):
        loop.init(np.zeros(7))
