"""Joints that follow an axis (<mimic>), against all joints in Pinocchio, and against MuJoCo.

In Pinocchio all joints are independent; virtual work takes its torques and inertias to the axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import pyarrow.parquet as pq
import pytest
from conftest import Shell
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mujoco_arms import stripped
from unit.arms import described_arm

from scarid_cli.algorithms.design.model import Model as Design
from scarid_cli.algorithms.plants.model import turned
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.mechanism import Mechanism
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.kernels import rigid


@dataclass(frozen=True)
class Joint:
    """A joint of a chain; `driver` (from 0) is the joint before it that it follows."""

    type: str
    axis: tuple[float, float, float]
    driver: int | None
    ratio: float
    offset: float


@st.composite
def chains(draw: st.DrawFn) -> list[Joint]:
    """Chains whose first joint is an axis; others may follow any joint before them."""
    small = st.integers(-4, 4).map(lambda k: 0.25 * k)
    joints = []
    for k in range(draw(st.integers(2, 5))):
        axis = draw(st.sampled_from([(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.6, 0, 0.8)]))
        follows = draw(st.none() | st.integers(0, k - 1)) if k else None
        ratio, offset = draw(small.filter(bool)), draw(small)
        kind = draw(st.sampled_from(["revolute", "prismatic"]))
        joints.append(Joint(kind, axis, follows, ratio, offset))
    return joints


def urdf(joints: list[Joint]) -> str:
    """The chain, every link with a mass off its axis."""
    parts = ['<robot name="r"><link name="l0"/>']
    for k, joint in enumerate(joints, start=1):
        follow = (
            f'<mimic joint="j{joint.driver + 1}" multiplier="{joint.ratio}" '
            f'offset="{joint.offset}"/>'
            if joint.driver is not None
            else ""
        )
        axis = " ".join(map(str, joint.axis))
        parts.append(
            f'<joint name="j{k}" type="{joint.type}"><parent link="l{k - 1}"/><child link="l{k}"/>'
            f'<origin xyz="0.1 0 0.3" rpy="0.2 0 0.1"/><axis xyz="{axis}"/>{follow}'
            '<limit lower="-1" upper="1" effort="2000" velocity="9"/></joint>'
            f'<link name="l{k}"><inertial><origin xyz="0.05 {0.01 * k} 0.1"/>'
            f'<mass value="{6 - k}"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.03"'
            ' iyz="0" izz="0.02"/></inertial></link>'
        )
    return "".join([*parts, "</robot>"])


def motions(joints: list[Joint]) -> tuple[Array, Array]:
    """The matrix and the offsets of all joints' positions by those of the axes."""
    axes = [k for k, joint in enumerate(joints) if joint.driver is None]
    A, c = np.zeros((len(joints), len(axes))), np.zeros(len(joints))
    for k, joint in enumerate(joints):
        if joint.driver is None:
            A[k, axes.index(k)] = 1.0
        else:
            A[k] = joint.ratio * A[joint.driver]
            c[k] = joint.ratio * c[joint.driver] + joint.offset
    return A, c


def loaded(joints: list[Joint], folder: Path) -> Robot:
    path = folder / "robot.urdf"
    path.write_text(urdf(joints))
    axes = "".join(
        f'[[joint]]\nname = "j{k}"\n'
        for k, joint in enumerate(joints, start=1)
        if joint.driver is None
    )
    (folder / "robot.toml").write_text(f'title = "r"\nurdf = "robot.urdf"\n{axes}')
    return load(str(folder / "robot.toml"))


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(chains(), st.integers(0, 1000))
def test_torques_and_inertias_are_those_of_all_joints(
    tmp_path_factory: pytest.TempPathFactory, joints: list[Joint], seed: int
) -> None:
    robot = loaded(joints, tmp_path_factory.mktemp("chain"))
    A, c = motions(joints)
    n = A.shape[1]
    q, dq, ddq = np.random.default_rng(seed).uniform(-2.0, 2.0, (3, n))
    other = pinocchio.buildModelFromXML(urdf(joints))
    data = other.createData()
    wanted = A.T @ pinocchio.rnea(other, data, A @ q + c, A @ dq, A @ ddq)
    matrix = pinocchio.crba(other, data, A @ q + c)
    matrix = A.T @ (np.triu(matrix) + np.triu(matrix, 1).T) @ A
    body, still = robot.body, A @ (0.0 * dq)
    assert body
    torques = body.columns(q[:, None], dq[:, None], ddq[:, None])[0] @ np.array(body.standard)
    np.testing.assert_allclose(torques, wanted, rtol=1e-9, atol=1e-9)
    links = np.array(body.standard).reshape(-1, 10)
    chain = Mechanism(body.axes, links, np.array(body.gravity), body.following)
    bias, found = np.zeros(n), np.zeros((n, n))
    rigid.dynamics(turned(chain), chain.gravity, np.array([q, 0.0 * q]), bias, found)
    np.testing.assert_allclose(found, matrix, rtol=1e-9, atol=1e-9)
    weight = A.T @ pinocchio.rnea(other, data, A @ q + c, still, still)
    np.testing.assert_allclose(bias, weight, rtol=1e-9, atol=1e-9)
    theta = np.array([p.apriori for p in robot.parameters])
    base = robot.regressor(q[:, None], dq[:, None], ddq[:, None])[0] @ theta
    np.testing.assert_allclose(base, wanted, rtol=1e-3, atol=1e-3)  # what base.py takes as nothing


LEVEL = [
    Joint("revolute", (0, 1, 0), None, 1.0, 0.0),
    Joint("revolute", (0, 1, 0), None, 1.0, 0.0),
    Joint("revolute", (0, 1, 0), 0, -1.0, 0.5),
    Joint("revolute", (0, 1, 0), 1, -1.0, 0.0),
]
TELESCOPE = [
    Joint("revolute", (0, 1, 0), None, 1.0, 0.0),
    Joint("prismatic", (0, 0, 1), None, 1.0, 0.0),
    *(Joint("prismatic", (0, 0, 1), 1, 1.0, 0.0) for _ in range(3)),
]


def test_the_slopes_for_the_design_of_motions(tmp_path: Path) -> None:
    """Against central differences."""
    robot = loaded(LEVEL, tmp_path)
    design = Design.of(robot)
    rng = np.random.default_rng(1)
    motion = rng.uniform(-1.0, 1.0, (3, 2, 4))
    G = rng.standard_normal((4, 2, len(robot.parameters)))
    slopes = np.array(design.gradient(tuple(motion), G))
    step = 1e-5
    for place in np.ndindex(*motion.shape):
        ends = []
        for sign in (1.0, -1.0):
            moved = motion.copy()
            moved[place] += sign * step
            ends.append(float(np.sum(G * design.regressor(tuple(moved)))))
        assert slopes[place] == pytest.approx(
            (ends[0] - ends[1]) / (2.0 * step), rel=1e-5, abs=1e-6
        )


def test_points_move_with_the_joints_that_follow(tmp_path: Path) -> None:
    robot = loaded(TELESCOPE, tmp_path)
    assert robot.body
    A, c = motions(TELESCOPE)
    q = np.array([0.3, 0.2])
    other = pinocchio.buildModelFromXML(urdf(TELESCOPE))
    data = other.createData()
    pinocchio.framesForwardKinematics(other, data, A @ q + c)
    wanted = data.oMf[other.getFrameId("l5")].translation
    found, _ = robot.body.pose(q[:, None]).positions(robot.body.points("l5"))
    np.testing.assert_allclose(found[0, 0], wanted, atol=1e-12)


TERMS = "terms = { inertia = 0.05, viscous = 1.0, coulomb = 0.8, offset = 0.1 }"


def with_friction(joints: list[Joint], folder: Path) -> str:
    """A description with friction and motors, as a file."""
    (folder / "robot.urdf").write_text(urdf(joints))
    axes = [k for k, joint in enumerate(joints, start=1) if joint.driver is None]
    lines = "".join(
        f'[[joint]]\nname = "j{k}"\n{TERMS}\nacceleration_limit = 9.0\nencoder_resolution = 2e-5\n'
        f"torque_noise = 0.05\n"
        for k in axes
    )
    described_arm("robot.urdf", folder, lines)
    return "robot.toml"


@pytest.mark.parametrize("joints", [LEVEL, TELESCOPE], ids=["levelling", "telescope"])
def test_the_pipe_identifies_what_follows(
    joints: list[Joint], shell: Shell, tmp_path: Path
) -> None:
    robot = load(str(tmp_path / with_friction(joints, tmp_path)))
    pipe = (
        "scarid trajgen --robot robot.toml --duration 12 --seed 1 | "
        "scarid simulate --robot robot.toml --seed 2 -o log.parquet"
    )
    assert shell(pipe).status == 0
    done = shell("scarid identify log.parquet -o p.parquet")
    assert done.status == 0, done.err
    assert "good: " in done.err
    judged(tmp_path, robot)


def judged(folder: Path, robot: Robot) -> None:
    """The true values are within the 95 % intervals, but for one at most."""
    rows = pq.read_table(folder / "p.parquet").to_pydict()
    truth = dict(zip(robot.names, robot.apriori, strict=True))
    ends = zip(rows["parameter"], rows["low"], rows["high"], strict=True)
    outside = [name for name, low, high in ends if not low <= truth[name] <= high]
    assert len(outside) <= 1, outside


def moved_by_mujoco(joints: list[Joint], folder: Path) -> tuple[Array, Array, Array]:
    """Times, positions of the axes and their torques under a PD law; equalities tie the others."""
    names = [f"j{k}" for k in range(1, len(joints) + 1)]
    body = mujoco.MjSpec.from_string(stripped(folder / "robot.urdf", names))
    for k, joint in enumerate(joints):
        if joint.driver is not None:
            tie = body.add_equality()
            tie.type = mujoco.mjtEq.mjEQ_JOINT
            tie.name1, tie.name2 = f"j{k + 1}", f"j{joint.driver + 1}"
            tie.data[:5] = [joint.offset, joint.ratio, 0.0, 0.0, 0.0]
            tie.solref[:] = [5e-4, 1.0]
            tie.solimp[:3] = [0.9999, 0.9999, 1e-3]
    compiled = body.compile()
    compiled.opt.timestep = 2.5e-4
    compiled.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    compiled.opt.gravity[:] = (0.0, 0.0, -9.81)
    compiled.jnt_limited[:] = 0
    axes = [k for k, joint in enumerate(joints) if joint.driver is None]
    compiled.dof_armature[axes] = 0.05
    compiled.dof_damping[axes] = 1.0
    _, c = motions(joints)
    data = mujoco.MjData(compiled)
    data.qpos[:] = c
    rows = []
    for tick in range(12000):
        t = tick * 1e-3
        q, dq = data.qpos[axes], data.qvel[axes]
        wave = np.sin(np.array([1.3, 3.1, 2.2, 4.7]) * t)
        wanted = 0.4 * np.array([wave[0] + wave[1], wave[2] - wave[3]])
        force = 900.0 * (wanted - q) - 90.0 * dq
        data.qfrc_applied[axes] = force
        rows.append([t, *q, *force])
        for _ in range(4):
            mujoco.mj_step(compiled, data)
    table = np.array(rows)
    return table[:, 0], table[:, 1:3], table[:, 3:5]


@pytest.mark.parametrize("joints", [LEVEL, TELESCOPE], ids=["levelling", "telescope"])
def test_what_mujoco_moves_is_identified(joints: list[Joint], shell: Shell, tmp_path: Path) -> None:
    """The ties of MuJoCo give way a little; the largest error is 1 % of what each joint needs."""
    with_friction(joints, tmp_path)
    t, q, tau = moved_by_mujoco(joints, tmp_path)
    header = "t,q1,q2,tau1,tau2"
    np.savetxt(tmp_path / "log.csv", np.column_stack((t, q, tau)), delimiter=",", header=header,
               comments="")  # fmt: skip
    done = shell("scarid identify --robot robot.toml log.csv -o p.parquet")
    assert done.status == 0, done.err
    rows = pq.read_table(tmp_path / "p.parquet").to_pydict()
    found = dict(zip(rows["parameter"], rows["estimate"], strict=True))
    robot = load(str(tmp_path / "robot.toml"))
    truth = {p.name: 0.0 if p.name[:2] in ("fs", "of") else p.apriori for p in robot.parameters}
    rng = np.random.default_rng(0)
    motion = rng.uniform(-1.0, 1.0, (3, 2, 200))
    W = robot.regressor(*motion)
    wanted = W @ np.array([truth[name] for name in robot.names])
    away = W @ np.array([found[name] for name in robot.names]) - wanted
    assert np.all(away.std(axis=0) < 0.02 * wanted.std(axis=0))
