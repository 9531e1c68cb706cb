"""Bodies, motors and friction in MuJoCo and in URDFs, for arms of all kinds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT
from unit.arms import FINGERS, URDF, described_arm, seven_axes
from unit.test_following import LEVEL, TELESCOPE, urdf

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.drives import drives
from scarid_cli.algorithms.robots.physical import Physical, nearest
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.stages.models.intervals import Interval
from scarid_cli.stages.models.mjcf import mjcf
from scarid_cli.stages.urdf import document

mujoco = pytest.importorskip("mujoco")
pytest.importorskip("pinocchio")
pytest.importorskip("cvxpy")
FRICTION = (
    "inertia = 0.2, viscous = 0.5, coulomb-forward = 0.6, coulomb-backward = 0.8, offset = 0.1"
)


def moved(robot: Robot) -> Physical:
    """Consistent bodies near parameters that are a little off those of the description."""
    rng = np.random.default_rng(3)
    theta = robot.apriori * rng.uniform(0.9, 1.1, len(robot.parameters))
    theta += 0.02 * (theta == 0.0)
    return nearest(robot, theta, np.diag((0.05 * np.abs(theta) + 1e-3) ** 2))


def with_terms(text: str, names: list[str], folder: Path, more: str = "") -> Robot:
    (folder / "arm.urdf").write_text(text)
    axes = "".join(f'[[joint]]\nname = "{j}"\nterms = {{ {FRICTION} }}\n' for j in names)
    return described_arm("arm.urdf", folder, more + axes)


def arms(name: str, folder: Path) -> Robot:
    if name == "coupled":
        return load(str(ROOT / "samples" / "arm.toml"))
    if name == "ur10e":
        return load(str(ROOT / "samples" / "robots" / "ur10e.toml"))
    if name == "seven":
        coupling = "[[coupling]]\njoints = [1, 2]\nratio = 3.0\n"
        return with_terms(seven_axes(), [f"j{i}" for i in range(1, 8)], folder, coupling)
    if name == "locked":
        text = URDF.replace("TYPE", "prismatic").replace("</robot>", FINGERS + "</robot>")
        return with_terms(text, ["a", "b"], folder, "posture = { left = 0.03 }\n")
    return with_terms(urdf(LEVEL if name == "level" else TELESCOPE), ["j1", "j2"], folder)


@pytest.mark.parametrize("name", ["coupled", "ur10e", "seven", "locked", "level", "telescope"])
def test_mujoco_has_the_torques_of_the_regressor(name: str, tmp_path: Path) -> None:
    """Where friction slides: MuJoCo's is full above 1 rad/s at these accelerations."""
    robot = arms(name, tmp_path)
    assert robot.body
    found = moved(robot)
    text = document(Path(robot.body.path).read_text(), robot, found, "a test")
    rows = [Interval("Iyy1", "kg m2", 1.0, 0.9, 1.25)]
    made, remarks = mjcf(text, robot, found, "a test", rows)
    assert not any("warning" in remark for remark in remarks)
    model = mujoco.MjModel.from_xml_string(made)
    np.testing.assert_allclose(model.numeric("Iyy1").data[1:], [1.0, 0.9, 1.25])
    model.jnt_limited[:] = 0
    data, follows, n = mujoco.MjData(model), robot.body.following, len(robot.joints)
    places = [model.joint(joint).dofadr[0] for joint in robot.body.moving]
    assert model.nv == len(places)
    constant = np.array([axis.constant for axis in drives(robot, found.axes).axes])
    rng = np.random.default_rng(1)
    for _ in range(20):
        q, ddq = rng.uniform(-1.0, 1.0, (2, n, 1))
        dq = rng.choice([-1.0, 1.0], (n, 1)) * rng.uniform(1.0, 2.0, (n, 1))
        data.qpos[places] = follows.positions(q)[:, 0]
        data.qvel[places], data.qacc[places] = follows.rates(dq)[:, 0], follows.rates(ddq)[:, 0]
        mujoco.mj_inverse(model, data)
        tau = follows.torques(data.qfrc_inverse[places]) + constant
        wanted = robot.regressor(q, dq, ddq)[0] @ found.base
        if not robot.motors or _apart(robot, dq):
            np.testing.assert_allclose(tau, wanted, rtol=0.0, atol=1e-9)


def _apart(robot: Robot, dq: Array) -> bool:
    """Whether the friction of all coupling motors slides fast."""
    return all(abs(float(motor.speed(dq)[0])) > 0.5 for motor in robot.motors)


def test_the_motors_of_mujoco_turn_as_those_of_the_log(tmp_path: Path) -> None:
    """A torque of each motor, and what its joints then feel: R' of it, less the offsets."""
    robot = arms("coupled", tmp_path)
    assert robot.body
    assert robot.log
    found = moved(robot)
    text = document(Path(robot.body.path).read_text(), robot, found, "a test")
    model = mujoco.MjModel.from_xml_string(mjcf(text, robot, found, "a test", [])[0])
    data = mujoco.MjData(model)
    data.ctrl[:] = 0.3, -0.2
    mujoco.mj_forward(model, data)
    axes = found.axes
    constant = [0.5 * (axes["fs1+"] - axes["fs1-"]), axes["off2"]]
    wanted = np.array(robot.log.ratios).T @ [0.3, -0.2] - constant
    np.testing.assert_allclose(data.qfrc_actuator, wanted, rtol=0.0, atol=1e-9)


def test_a_transmission_that_is_there_is_completed_and_not_doubled(tmp_path: Path) -> None:
    own = (
        '<transmission name="t"><joint name="a"/><actuator name="m">'
        "<mechanicalReduction>10</mechanicalReduction></actuator></transmission></robot>"
    )
    text = URDF.replace("TYPE", "revolute").replace("</robot>", own)
    robot = with_terms(text, ["a", "b"], tmp_path)
    found = moved(robot)
    made = document(text, robot, found, "a test")
    assert made.count("<transmission ") == 2
    assert f'<drake:rotor_inertia value="{found.axes["Ia1"] / 100.0!r}"' in made
