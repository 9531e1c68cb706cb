"""The compiled regressor of a chain, against a second formulation and Pinocchio; its reverse pass,
against finite differences."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scarid_cli.algorithms.robots import newton_euler
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.following import Following
from scarid_cli.algorithms.robots.mechanism import Mechanism, mechanism
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.rigid import PINOCCHIO
from scarid_cli.algorithms.robots.terms import AxisTerm

JOINTS, SAMPLES = 5, 4


def skew(x: np.ndarray) -> np.ndarray:
    return np.array([[0.0, -x[2], x[1]], [x[2], 0.0, -x[0]], [-x[1], x[0], 0.0]])


def rotation(rng: np.random.Generator) -> np.ndarray:
    Q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    return Q * np.sign(np.linalg.det(Q))


def oblique(rng: np.random.Generator) -> Mechanism:
    """Axes of any direction, two of them prismatic, the frames turned and shifted at will."""
    axes = np.zeros((JOINTS, 16))
    for row in axes:
        row[:9] = rotation(rng).ravel()
        row[9:12] = rng.standard_normal(3)
        direction = rng.standard_normal(3)
        row[12:15] = direction / np.linalg.norm(direction)
    axes[[1, 3], 15] = 1.0
    gravity = 9.0 * rng.standard_normal(3)
    return Mechanism(axes, rng.standard_normal((JOINTS, 10)), gravity, Following.none(JOINTS))


def frames(axes: np.ndarray, q: np.ndarray) -> list[np.ndarray]:
    """Homogeneous matrices from the frame of each link to the base, from matrix exponentials."""
    from scipy.linalg import expm

    place = np.eye(4)
    found = []
    for axis, angle in zip(axes, q, strict=True):
        fixed, moved = np.eye(4), np.zeros((4, 4))
        fixed[:3, :3], fixed[:3, 3] = axis[:9].reshape(3, 3), axis[9:12]
        if axis[15]:
            moved[:3, 3] = axis[12:15]
        else:
            moved[:3, :3] = skew(axis[12:15])
        place = place @ fixed @ expm(angle * moved)
        found.append(place)
    return found


def energies(mechanism: Mechanism, q: np.ndarray, dq: np.ndarray) -> tuple[float, float]:
    """Kinetic and potential energy, from the trace form with pseudo-inertias."""
    step = 1e-5
    kinetic = potential = 0.0
    ahead, behind = (frames(mechanism.axes, q + s * step * dq) for s in (1.0, -1.0))
    for link, place, T1, T0 in zip(
        mechanism.links, frames(mechanism.axes, q), ahead, behind, strict=True
    ):
        Ixx, Ixy, Ixz, Iyy, Iyz, Izz, mx, my, mz, m = link
        inertia = np.array([[Ixx, Ixy, Ixz], [Ixy, Iyy, Iyz], [Ixz, Iyz, Izz]])
        J = np.zeros((4, 4))
        J[:3, :3] = 0.5 * np.trace(inertia) * np.eye(3) - inertia
        J[3, :3] = J[:3, 3] = mx, my, mz
        J[3, 3] = m
        rate = (T1 - T0) / (2.0 * step)
        kinetic += 0.5 * np.trace(rate @ J @ rate.T)
        potential -= mechanism.gravity @ (place @ J[:, 3])[:3]
    return kinetic, potential


def test_the_regressor_gives_the_change_of_energy() -> None:
    """Power dq' tau = d(kinetic + potential)/dt along a smooth motion, for axes of any direction.

    Energies are taken from homogeneous matrices and pseudo-inertias (no recursion).
    """
    rng = np.random.default_rng(1)
    chain = oblique(rng)
    a, b, c = rng.uniform(-1.0, 1.0, (3, JOINTS))

    def motion(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return a + b * t + c * t**2, b + 2.0 * c * t, 2.0 * c

    q, dq, ddq = (x[:, None] for x in motion(0.3))
    W = newton_euler.regressor(chain.axes, chain.gravity, q, dq, ddq)
    power = dq[:, 0] @ (W[0] @ chain.links.ravel())
    step = 1e-4
    later, before = (sum(energies(chain, *motion(0.3 + s * step)[:2])) for s in (1.0, -1.0))
    assert power == pytest.approx((later - before) / (2.0 * step), rel=1e-5)


def test_the_regressor_at_rest_is_the_slope_of_the_potential_energy() -> None:
    rng = np.random.default_rng(2)
    chain = oblique(rng)
    q = rng.uniform(-3.0, 3.0, JOINTS)
    rest = np.zeros((JOINTS, 1))
    W = newton_euler.regressor(chain.axes, chain.gravity, q[:, None], rest, rest)
    torques = W[0] @ chain.links.ravel()
    step = 1e-5
    rounding = 1e-7 * np.max(np.abs(torques))  # of the energies, whose difference may be small
    for i, e in enumerate(np.eye(JOINTS)):
        up, down = (energies(chain, q + s * step * e, 0.0 * q)[1] for s in (1.0, -1.0))
        assert torques[i] == pytest.approx((up - down) / (2.0 * step), abs=rounding)


def test_a_sample_does_not_depend_on_the_batch() -> None:
    rng = np.random.default_rng(3)
    chain = oblique(rng)
    motion = rng.uniform(-3.0, 3.0, (3, JOINTS, 50))
    whole = newton_euler.regressor(chain.axes, chain.gravity, *motion)
    parts = [
        newton_euler.regressor(chain.axes, chain.gravity, *motion[:, :, piece])
        for piece in (slice(0, 1), slice(1, 8), slice(8, 50))
    ]
    np.testing.assert_array_equal(whole, np.concatenate(parts))


def test_torques_by_forces_are_those_of_the_regressor() -> None:
    rng = np.random.default_rng(6)
    chain = oblique(rng)
    motion = rng.uniform(-3.0, 3.0, (3, JOINTS, 50))
    W = newton_euler.regressor(chain.axes, chain.gravity, *motion)
    expected = (W @ chain.links.ravel()).T
    found = newton_euler.torques(chain.axes, chain.gravity, *motion, chain.links)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("signal", [0, 1, 2], ids=["q", "dq", "ddq"])
def test_the_reverse_pass_gives_the_slopes(signal: int) -> None:
    """Against central differences of the regressor, for axes of any direction."""
    rng = np.random.default_rng(4)
    chain = oblique(rng)
    motion = rng.uniform(-3.0, 3.0, (3, JOINTS, SAMPLES))
    G = rng.standard_normal((SAMPLES, JOINTS, 10 * JOINTS))
    slopes = newton_euler.gradient(chain.axes, chain.gravity, *motion, G)[signal]
    step = 1e-4
    numeric = np.empty_like(slopes)
    for i in range(JOINTS):
        values = []
        for place in (-2.0, -1.0, 1.0, 2.0):
            moved = motion.copy()
            moved[signal, i] += place * step
            W = newton_euler.regressor(chain.axes, chain.gravity, *moved)
            values.append(np.sum(G * W, axis=(1, 2)))
        a, b, c, d = values
        numeric[i] = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step)
    np.testing.assert_allclose(slopes, numeric, rtol=0, atol=1e-9 * np.abs(numeric).max())


SLIDE = """<robot name="slide"><link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="one"/>
    <origin xyz="0.1 0.2 0.3" rpy="0.4 -0.5 0.6"/><axis xyz="0.6 0 0.8"/>
    <limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
  <link name="one"/>
  <joint name="b" type="prismatic"><parent link="one"/><child link="two"/>
    <origin xyz="-0.2 0.1 0.5" rpy="0.7 0.2 -0.3"/><axis xyz="0.48 -0.6 0.64"/>
    <limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
  <link name="two"/>
  <joint name="c" type="continuous"><parent link="two"/><child link="three"/>
    <origin xyz="0.3 -0.1 0.2" rpy="-0.1 0.9 0.5"/><axis xyz="0 -1 0"/></joint>
  <link name="three"/>
</robot>"""


def by_pinocchio(robot: Robot, q: np.ndarray, dq: np.ndarray, ddq: np.ndarray) -> np.ndarray:
    """The regressor of the standard parameters, sample by sample."""
    pinocchio = pytest.importorskip("pinocchio")
    assert robot.body
    model = robot.body.model
    data = model.createData()
    joints, samples = q.shape
    W = np.empty((samples, joints, 10 * joints))
    order = (10 * np.arange(joints)[:, None] + PINOCCHIO).ravel()
    for k in range(samples):
        Y = pinocchio.computeJointTorqueRegressor(model, data, q[:, k], dq[:, k], ddq[:, k])
        W[k] = Y.reshape(joints, -1)[:, order]
    return W


@pytest.mark.parametrize("name", ["ur10", "panda", "xarm7", "so101", "oblique slide"])
def test_the_regressor_is_that_of_pinocchio(name: str, tmp_path: Path, request: Any) -> None:
    if name == "oblique slide":
        path = tmp_path / "slide.urdf"
        path.write_text(SLIDE)
    else:
        path = request.getfixturevalue("real_logs") / "urdf" / f"{name}.urdf"
    robot = load(str(path))
    assert robot.body
    motion = np.random.default_rng(5).uniform(-3.0, 3.0, (3, len(robot.joints), 50))
    expected = by_pinocchio(robot, *motion)
    found = robot.body.columns(*motion)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["scara2", "planar2-gravity", "emps"])
def test_a_robot_without_a_urdf_has_the_torques_of_its_chain(name: str) -> None:
    """The links of the chain, with the friction of the robot's own terms."""
    robot = load(name)
    chain = mechanism(robot)
    motion = np.random.default_rng(6).uniform(-3.0, 3.0, (3, len(robot.joints), 50))
    rigid = newton_euler.regressor(chain.axes, chain.gravity, *motion) @ chain.links.ravel()
    own = [isinstance(p.term, AxisTerm) for p in robot.parameters]
    W = robot.regressor(*motion)
    expected = robot.torques(W, robot.apriori)
    found = rigid.T + robot.torques(W, np.where(own, robot.apriori, 0.0))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * np.abs(expected).max())
