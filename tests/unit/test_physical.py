"""Bodies that can exist, nearest to identified parameters, and the URDF that has them."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from unit.arms import URDF, described_arm

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.physical import nearest, pseudo_inertia
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.stages.urdf import document

pinocchio = pytest.importorskip("pinocchio")
pytest.importorskip("cvxpy")


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    path = tmp_path / "two.urdf"
    path.write_text(URDF.replace("TYPE", "revolute"))
    return described_arm(str(path), tmp_path, "")


def torques_of(urdf: str, q: Array, dq: Array, ddq: Array) -> Array:
    """By Pinocchio's recursive Newton-Euler, without friction."""
    model = pinocchio.buildModelFromXML(urdf)
    data = model.createData()
    samples = zip(q.T, dq.T, ddq.T, strict=True)
    return np.transpose([pinocchio.rnea(model, data, *sample).copy() for sample in samples])


def test_parameters_of_bodies_that_exist_stay_and_give_those_bodies_back(robot: Robot) -> None:
    found = nearest(robot, robot.apriori, np.full(len(robot.parameters), 0.01))
    assert np.abs(found.moved).max() < 0.01
    np.testing.assert_allclose(found.base, robot.apriori, atol=1e-4)
    assert robot.body
    own = np.reshape(robot.body.standard, (2, 10))
    np.testing.assert_allclose(found.bodies, own, atol=2e-3)


def test_the_urdf_has_the_torques_of_the_base_parameters(robot: Robot) -> None:
    """Of parameters that were moved, for bodies alone: without friction and motor inertia."""
    rng = np.random.default_rng(0)
    theta = robot.apriori * rng.uniform(0.9, 1.1, len(robot.parameters))
    found = nearest(robot, theta, 0.1 * np.abs(theta) + 1e-3)
    assert robot.body
    text = document(Path(robot.body.path).read_text(), robot, found, "scarid urdf --test")
    motion = rng.standard_normal((3, 2, 20))
    of_bodies = found.base.copy()
    for i, parameter in enumerate(robot.parameters):
        of_bodies[i] -= sum(factor * found.axes.get(name, 0.0) for name, factor in parameter.parts)
    expected = robot.torques(robot.regressor(*motion), of_bodies)
    np.testing.assert_allclose(torques_of(text, *motion), expected, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_parameters_of_no_body_are_moved_to_one_that_can_exist(robot: Robot, seed: int) -> None:
    """A moment of inertia below what its first moment needs: positive definite again."""
    rng = np.random.default_rng(seed)
    theta = robot.apriori + rng.normal(0.0, 0.5, len(robot.parameters))
    theta[robot.names.index("Iyy2")] = -0.2
    theta[robot.names.index("fv1")] = -1.0
    errors = np.full(len(theta), 0.1)
    found = nearest(robot, theta, errors)
    for body in found.bodies:
        assert np.linalg.eigvalsh(pseudo_inertia(body))[0] > 0.0
    assert (
        min(value for name, value in found.axes.items() if name[:2] in ("Ia", "fv", "fs")) > -1e-6
    )
    np.testing.assert_allclose(found.moved, (found.base - theta) / errors)
    assert found.moved[robot.names.index("Iyy2")] > 2.0
    np.testing.assert_allclose(found.base[robot.names.index("fv1")], 0.0, atol=1e-4)


def test_no_feasible_point_is_nearer(robot: Robot) -> None:
    """Random bodies that exist, and all on the way to them from the one found, are farther.

    Real bodies are a convex set, so that this is what the nearest is.
    """
    rng = np.random.default_rng(3)
    theta = robot.apriori.copy()
    theta[robot.names.index("Iyy2")] = -0.05
    errors = np.full(len(theta), 0.1)
    found = nearest(robot, theta, errors)
    best = float(np.sum(found.moved**2))
    names = [f"{s}{i}" for i in (1, 2) for s in
             ("Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz", "mx", "my", "mz", "m")]  # fmt: skip
    assert robot.body
    for _ in range(200):
        cloud = [rng.normal(0.0, 0.15, (4, 3)) + rng.normal(0.05, 0.05, 3) for _ in range(2)]
        values = dict(zip(names, np.concatenate([_of_points(c, rng) for c in cloud]), strict=True))
        base = [sum(f * values.get(name, 0.0) for name, f in p.parts) for p in robot.parameters]
        for share in (0.01, 0.1, 1.0):
            between = (1.0 - share) * found.base + share * np.array(base)
            assert (
                np.sum(((between - theta) / errors) ** 2) > best - 1e-3
            )  # what the price may move


def _of_points(places: Array, rng: np.random.Generator) -> Array:
    """Standard parameters of point masses."""
    masses = rng.uniform(0.0, 0.7, len(places))
    inertia = sum(
        (m * (p @ p * np.eye(3) - np.outer(p, p)) for m, p in zip(masses, places, strict=True)),
        np.zeros((3, 3)),
    )
    return np.array([*inertia[np.triu_indices(3)], *(masses @ places), masses.sum()])


def test_a_parameter_without_an_error_is_free(robot: Robot) -> None:
    theta = robot.apriori.copy()
    theta[0] = 100.0
    errors = np.full(len(theta), 0.01)
    errors[0] = np.nan
    found = nearest(robot, theta, errors)
    assert np.abs(found.moved[1:]).max() < 0.01
    assert found.base[0] < 1.0


def test_everything_else_of_the_urdf_stays(robot: Robot) -> None:
    assert robot.body
    text = Path(robot.body.path).read_text()
    text = text.replace('<link name="base"/>', '<link name="base"/><!-- a note -->')
    text = text.replace(
        "</robot>",
        '<joint name="tip" type="fixed"><parent link="two"/><child link="tool"/></joint>'
        '<link name="tool"><inertial><mass value="0.3"/><inertia ixx="0.001" ixy="0" ixz="0"'
        ' iyy="0.001" iyz="0" izz="0.001"/></inertial><visual/></link></robot>',
    )
    Path(robot.body.path).with_name("tool.urdf").write_text(text)
    arm = load(str(Path(robot.body.path).with_name("tool.urdf")))
    found = nearest(arm, arm.apriori, np.full(len(arm.parameters), 0.01))
    written = document(text, arm, found, "scarid urdf")
    for part in (
        "<!-- a note -->",
        '<limit lower="-3" upper="3" effort="9" velocity="9"',
        "<visual",
    ):
        assert part in written
    # The tool is fixed to link two: its mass is counted there, once.
    assert found.bodies[1][9] == pytest.approx(1.3, abs=0.02)
    motion = np.random.default_rng(0).standard_normal((3, 2, 5))
    np.testing.assert_allclose(torques_of(written, *motion), torques_of(text, *motion), atol=0.05)


def test_without_cvxpy_the_extra_is_named(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cvxpy", None)
    with pytest.raises(UsageFault, match=r"pip install 'scarid\[urdf\]'"):
        nearest(robot, robot.apriori, np.ones(len(robot.parameters)))
