"""The simulated arm against MuJoCo, with friction as hard as MuJoCo can have it."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from conftest import ROOT
from mujoco_arms import stripped
from unit.arms import described_arm
from unit.plants import closed_loop

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

STEP = 0.25e-3  # s, of MuJoCo
PERIOD = 1e-3
INERTIA, VISCOUS, COULOMB = (0.5, 0.05), (2.0, 0.2), (2.0, 0.04)  # of the first and the last joint


def along(ends: tuple[float, float], joints: int) -> Array:
    return np.geomspace(*ends, joints)


def arm(urdf: Path, folder: Path) -> Robot:
    """The arm of a URDF with motors and friction."""
    tree = ElementTree.parse(urdf).getroot()
    names = [str(j.get("name")) for j in tree.findall("joint") if j.get("type") == "revolute"]
    rows = np.array([along(x, len(names)) for x in (INERTIA, VISCOUS, COULOMB)]).T
    lines = "".join(
        f"[[joint]]\nname = '{name}'\nterms = {{ inertia = {a}, viscous = {b}, coulomb = {c} }}\n"
        for name, (a, b, c) in zip(names, rows.tolist(), strict=True)
    )
    return described_arm(str(urdf), folder, lines)


def other(urdf: Path, robot: Robot) -> mujoco.MjModel:
    """MuJoCo's model of the same arm."""
    assert robot.body
    model = mujoco.MjModel.from_xml_string(stripped(urdf, robot.body.joint_names))
    model.opt.timestep = STEP
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.gravity[:] = robot.body.gravity
    model.opt.iterations, model.opt.tolerance = 200, 0.0
    model.jnt_limited[:] = 0
    model.dof_armature[:] = along(INERTIA, model.nv)
    model.dof_damping[:] = along(VISCOUS, model.nv)
    model.dof_frictionloss[:] = along(COULOMB, model.nv)
    model.dof_solref[:] = (-1.0, -2.0 / STEP)
    model.dof_solimp[:, :3] = (0.9999, 0.9999, 0.001)
    return model


def waves(robot: Robot, ticks: int) -> tuple[Array, Array]:
    """Positions and velocities wanted, from rest in the middle of the limits."""
    middle = [0.5 * (max(j.lower, -2.0) + min(j.upper, 2.0)) for j in robot.joints]
    n = len(middle)
    size, rate = np.linspace(0.5, 0.3, n)[:, None], np.linspace(1.0, 2.5, n)[:, None]
    phase = rate * PERIOD * np.arange(ticks)
    return np.array(middle)[:, None] + size * (1.0 - np.cos(phase)), size * rate * np.sin(phase)


@pytest.mark.parametrize("name", ["ur10", "panda", "arm"])
def test_positions_agree_with_mujoco(
    name: str, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    """The same controller on both, each with what it sees."""
    folder = ROOT / "samples"
    if name != "arm":
        folder = request.getfixturevalue("real_logs") / "urdf"
    urdf = folder / f"{name}.urdf"
    robot, ticks = arm(urdf, tmp_path), 6000
    model = other(urdf, robot)
    found = law(robot, "pd", 10.0)
    loop = closed_loop(robot, kp=found.kp, kd=found.kd, kind="pd")
    q_ref, dq_ref = waves(robot, ticks)
    log = loop.step(loop.init(q_ref[:, 0]), q_ref, dq_ref, 0.0 * q_ref)[1]
    assert np.all(np.ptp(np.sign(log.dq_true), axis=1) == 2.0)
    data = mujoco.MjData(model)
    data.qpos[:] = last = q_ref[:, 0]
    limits = np.array([joint.torque_limit for joint in robot.joints])
    difference = np.zeros(ticks)
    for k in range(ticks):
        q = data.qpos.copy()
        difference[k] = np.abs(q - log.q_true[:, k]).max()
        tau = found.kp * (q_ref[:, k] - q) + found.kd * (dq_ref[:, k] - (q - last) / PERIOD)
        data.qfrc_applied[:] = np.clip(tau, -limits, limits)
        mujoco.mj_step(model, data, round(PERIOD / STEP))
        last = q
    assert difference.max() < 1e-6
