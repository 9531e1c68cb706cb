"""Physically consistent inertias nearest to identified parameters, and the URDF with them."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from unit.arms import FINGERS, URDF, described_arm, seven_axes, sines

from scarid_cli.algorithms.regression.information import least_squares
from scarid_cli.algorithms.robots import newton_euler
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.physical import Physical, nearest, pseudo_inertia
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.stages.urdf import SHOWN, _first_few, document, held_report

pinocchio = pytest.importorskip("pinocchio")
pytest.importorskip("cvxpy")


@pytest.fixture
def robot(tmp_path: Path) -> Robot:
    path = tmp_path / "two.urdf"
    path.write_text(URDF.replace("TYPE", "revolute"))
    return described_arm(str(path), tmp_path, "")


def uncorrelated(robot: Robot, theta: Array, errors: Array) -> tuple[Physical, Array]:
    """The nearest in these errors, nan for a free parameter, and by how many each one moved."""
    covariance = np.diag(errors**2)
    free = np.isnan(errors)
    covariance[free, :] = covariance[:, free] = np.nan
    found = nearest(robot, theta, covariance)
    return found, (found.base - theta) / errors


def torques_of(urdf: str, q: Array, dq: Array, ddq: Array) -> Array:
    """By Pinocchio's recursive Newton-Euler, without friction."""
    model = pinocchio.buildModelFromXML(urdf)
    data = model.createData()
    samples = zip(q.T, dq.T, ddq.T, strict=True)
    return np.transpose([pinocchio.rnea(model, data, *sample).copy() for sample in samples])


def test_consistent_parameters_stay_and_give_the_bodies_of_the_urdf_back(robot: Robot) -> None:
    errors = np.full(len(robot.parameters), 0.01)
    found, moved = uncorrelated(robot, robot.apriori, errors)
    assert np.abs(moved).max() < 0.01
    assert found.distance == pytest.approx(np.linalg.norm(moved), abs=1e-6)
    np.testing.assert_allclose(found.base, robot.apriori, atol=1e-4)
    assert robot.body
    own = np.reshape(robot.body.standard, (2, 10))
    np.testing.assert_allclose(found.bodies, own, atol=2e-3)


def test_the_urdf_has_the_torques_of_the_base_parameters(robot: Robot) -> None:
    """Of parameters that were moved, for bodies alone: without friction and motor inertia."""
    rng = np.random.default_rng(0)
    theta = robot.apriori * rng.uniform(0.9, 1.1, len(robot.parameters))
    found, _ = uncorrelated(robot, theta, 0.1 * np.abs(theta) + 1e-3)
    assert robot.body
    text = document(Path(robot.body.path).read_text(), robot, found, "scarid urdf --test")
    motion = rng.standard_normal((3, 2, 20))
    of_bodies = found.base.copy()
    for i, parameter in enumerate(robot.parameters):
        of_bodies[i] -= sum(factor * found.axes.get(name, 0.0) for name, factor in parameter.parts)
    expected = robot.torques(robot.regressor(*motion), of_bodies)
    np.testing.assert_allclose(torques_of(text, *motion), expected, atol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_inconsistent_parameters_become_consistent(robot: Robot, seed: int) -> None:
    """Even a negative moment of inertia and negative friction."""
    rng = np.random.default_rng(seed)
    theta = robot.apriori + rng.normal(0.0, 0.5, len(robot.parameters))
    theta[robot.names.index("Iyy2")] = -0.2
    theta[robot.names.index("fv1")] = -1.0
    errors = np.full(len(theta), 0.1)
    found, moved = uncorrelated(robot, theta, errors)
    for body in found.bodies:
        assert np.linalg.eigvalsh(pseudo_inertia(body))[0] > 0.0
    assert (
        min(value for name, value in found.axes.items() if name[:2] in ("Ia", "fv", "fs")) > -1e-6
    )
    assert moved[robot.names.index("Iyy2")] > 2.0
    np.testing.assert_allclose(found.base[robot.names.index("fv1")], 0.0, atol=1e-4)


def test_no_feasible_point_is_nearer(robot: Robot) -> None:
    """Random clouds of point masses, and what lies between them and the nearest, are farther.

    Physically consistent bodies are a convex set, so this makes the nearest what it is.
    """
    rng = np.random.default_rng(3)
    theta = robot.apriori.copy()
    theta[robot.names.index("Iyy2")] = -0.05
    errors = np.full(len(theta), 0.1)
    found, moved = uncorrelated(robot, theta, errors)
    best = float(np.sum(moved**2))
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
    found, moved = uncorrelated(robot, theta, errors)
    assert np.abs(moved[1:]).max() < 0.01
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
    found, _ = uncorrelated(arm, arm.apriori, np.full(len(arm.parameters), 0.01))
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


@pytest.mark.parametrize("size", [1.0, 0.1])
def test_fingers_keep_a_mass_of_their_own(tmp_path: Path, size: float) -> None:
    """Simulators refuse moving links without one; together with their link they are its body.

    Where that is lighter than what the description has for the fingers, they keep a part.
    """
    text = URDF.replace("TYPE", "revolute").replace("</robot>", f"{FINGERS}</robot>")
    (tmp_path / "hand.urdf").write_text(text)
    arm = load(str(tmp_path / "hand.urdf"))
    assert arm.body
    bodies = np.reshape(arm.body.standard, (2, 10)) * np.array([[1.0], [size]])
    found = Physical(bodies, {}, arm.apriori, 0.0)
    written = document(text, arm, found, "scarid urdf")
    rng = np.random.default_rng(0)
    held = np.tile([[0.0], [0.02]], 5)  # the second finger, by its <mimic>
    q = np.vstack((rng.standard_normal((2, 5)), held))
    rates = [np.vstack((x, np.zeros((2, 5)))) for x in rng.standard_normal((2, 2, 5))]
    expected = newton_euler.torques(arm.body.axes, np.array(arm.body.gravity), q[:2],
                                    rates[0][:2], rates[1][:2], bodies.ravel())  # fmt: skip
    np.testing.assert_allclose(torques_of(written, q, *rates)[:2], expected, atol=1e-9)
    (told,) = held_report(arm, found)
    assert told.startswith("left finger, right finger: behind joints that are no axes, with")
    assert ("of the masses" in told) == (size < 1.0)
    model = pinocchio.buildModelFromXML(written)
    assert all(model.inertias[j].mass > 0.0 for j in range(1, 5))


def test_without_cvxpy_the_extra_is_named(robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cvxpy", None)
    with pytest.raises(UsageFault, match=r"pip install 'scarid\[urdf\]'"):
        nearest(robot, robot.apriori, np.eye(len(robot.parameters)))


@dataclass(frozen=True)
class Experiment:
    """A seven-axis robot identified from five slow seconds (W), and a larger motion (cross)."""

    robot: Robot
    truth: Array
    W: Array
    cross: Array
    weights: Array
    estimates: Array
    covariance: Array

    def worst_r2(self, W: Array, theta: Array) -> float:
        """The lowest R2 of the seven joints, of the true torques."""
        tau = self.robot.torques(W, self.truth)
        residual = tau - self.robot.torques(W, theta)
        return float(np.min(1.0 - residual.var(axis=1) / tau.var(axis=1)))


@pytest.fixture(scope="module", params=(1, 3, 5))
def poor(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Experiment:
    """Of 69 parameters, many are known in combinations only: the condition number is 1e5.

    The bodies of the URDF have other centres of mass than those of the robot.
    """
    folder = tmp_path_factory.mktemp("seven")
    (folder / "arm.urdf").write_text(seven_axes())
    (folder / "true.urdf").write_text(seven_axes(centre="0.03 -0.04 0.05"))
    robot, truth = load(str(folder / "arm.urdf")), load(str(folder / "true.urdf")).apriori
    W = robot.regressor(*sines(7, 250, 0.3, request.param))
    tau = robot.torques(W, truth).T
    deviation = 0.1 * tau.std(axis=0)
    noise = deviation * np.random.default_rng(request.param).standard_normal(tau.shape)
    weights = np.ones_like(tau) / deviation
    fit = least_squares(W, tau + noise, weights)
    cross = robot.regressor(*sines(7, 450, 0.6, 50 + request.param))
    covariance = fit.variance * fit.unit_covariance
    return Experiment(robot, truth, W, cross, weights, fit.estimates, covariance)


def test_correlated_estimates_keep_their_torques(poor: Experiment) -> None:
    """The diagonal alone ruins them: R2 of the motion itself falls from .999 to .46 and .88."""
    found = nearest(poor.robot, poor.estimates, poor.covariance)
    assert poor.worst_r2(poor.W, poor.estimates) > 0.99
    assert poor.worst_r2(poor.W, found.base) > 0.99
    assert poor.worst_r2(poor.cross, found.base) > 0.97
    alone = nearest(poor.robot, poor.estimates, np.diag(np.diag(poor.covariance)))
    assert poor.worst_r2(poor.W, alone.base) < 0.9
    assert poor.worst_r2(poor.cross, alone.base) < 0.9


def test_consistent_parameters_are_no_farther_from_the_true_torques(poor: Experiment) -> None:
    """The projection on a convex set that has the truth in it: for any noise."""
    found = nearest(poor.robot, poor.estimates, poor.covariance)
    before, after = (
        np.linalg.norm(poor.weights * (poor.W @ (theta - poor.truth)))
        for theta in (poor.estimates, found.base)
    )
    assert after < before


def test_correlated_parameters_move_with_the_one_that_must(robot: Robot) -> None:
    """Negative friction becomes zero; the others follow by the regression of normal variables."""
    rng = np.random.default_rng(5)
    count = len(robot.parameters)
    root = 0.01 * np.eye(count) + 0.004 * rng.standard_normal((count, count))
    covariance = root @ root.T
    i = robot.names.index("fv1")
    theta = robot.apriori.copy()
    theta[[name[:2] in ("Ia", "fv", "fs") for name in robot.names]] = 1.0
    theta[i] = -0.05
    found = nearest(robot, theta, covariance)
    expected = theta - covariance[:, i] / covariance[i, i] * theta[i]
    np.testing.assert_allclose(found.base, expected, atol=1e-5)
    assert found.distance == pytest.approx(0.05 / np.sqrt(covariance[i, i]), rel=1e-3)


def test_dropping_parameters_is_least_squares_without_their_columns(robot: Robot) -> None:
    """If its solution is physically consistent: nothing else moves the estimates."""
    rng = np.random.default_rng(2)
    W = robot.regressor(*rng.uniform(-2.0, 2.0, (3, 2, 100)))
    theta = robot.apriori.copy()
    theta[[name[:2] in ("Ia", "fv", "fs") for name in robot.names]] = 1.0
    dropped = [robot.names.index(name) for name in ("off1", "off2", "fs2")]
    theta[dropped] = 0.0
    y = robot.torques(W, theta).T + 0.01 * rng.standard_normal((100, 2))
    fit = least_squares(W, y)
    kept = np.delete(np.arange(len(theta)), dropped)
    found = nearest(robot, fit.estimates, fit.variance * fit.unit_covariance, dropped)
    np.testing.assert_allclose(
        found.base[kept], least_squares(W[:, :, kept], y).estimates, atol=1e-4
    )
    assert np.all(found.base[dropped] == 0.0)
    assert found.axes["fs2"] == found.axes["off1"] == found.axes["off2"] == 0.0


def test_dropped_parameters_stay_at_zero_where_masses_are_positive(robot: Robot) -> None:
    """Iyy2 is the moment of inertia of link two and its motor: never zero, but small."""
    theta = robot.apriori.copy()
    names = ["off1", "fs2", "fv2", "Iyy2"]
    dropped = [robot.names.index(name) for name in names]
    covariance = 1e-4 * np.eye(len(theta))
    theta[dropped] = covariance[dropped, :] = covariance[:, dropped] = 0.0
    covariance[dropped, dropped] = np.nan
    found = nearest(robot, theta, covariance, dropped)
    assert np.all(found.base[dropped[:-1]] == 0.0)
    assert all(found.axes[name] == 0.0 for name in names[:-1])
    # The estimates come first: the first moment, 0.1 kg m, needs an inertia of its square by mass.
    assert 0.0 < found.base[dropped[-1]] < robot.apriori[dropped[-1]]
    others = np.delete(found.base - theta, dropped)
    assert np.linalg.norm(others) / 1e-2 < 1.1
    for body in found.bodies:
        assert np.linalg.eigvalsh(pseudo_inertia(body))[0] > 0.0


@pytest.mark.parametrize("count", [1, SHOWN, SHOWN + 1, 2 * SHOWN])
def test_a_list_is_shortened_where_something_is_left_out(count: int) -> None:
    items = [f"p{i}" for i in range(count)]
    named = [item for item in _first_few(items).split(", ") if item != "..."]
    assert named == items[: len(named)]
    assert _first_few(items).endswith(", ...") == (len(named) < count)


SMALL = """<robot name="small"><link name="base"/>{links}</robot>"""
LINK = """<link name="l{k}"><inertial><origin xyz="{com}"/><mass value="{mass}"/>
<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j{k}" type="revolute"><origin xyz="{at}" rpy="{rpy}"/><parent link="{parent}"/>
<child link="l{k}"/><axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="5" velocity="3"/></joint>
"""


def of_size(size: float, folder: Path) -> Robot:
    """An arm of lengths times `size`, and masses times its cube."""
    inertia = [size**5 * x for x in (0.02, 0.024, 0.006)]
    links = "".join(
        LINK.format(
            k=k, com=f"{0.2 * size} 0 0", mass=5.0 * size**3, x=inertia[0], y=inertia[1],
            z=inertia[2], at=f"{0.4 * size} 0 0", rpy="1.5708 0 0",
            parent="base" if k == 1 else f"l{k - 1}",
        )
        for k in (1, 2, 3)
    )  # fmt: skip
    path = folder / "arm.urdf"
    path.write_text(SMALL.format(links=links))
    return load(str(path))


def exact(robot: Robot, size: float) -> Array:
    return np.diag((1e-4 * np.maximum(np.abs(robot.apriori), size**5 * 1e-3)) ** 2)


@pytest.mark.parametrize("size", [0.05, 0.1, 1.0])
def test_the_bodies_of_a_small_arm_are_possible_however_small(size: float, tmp_path: Path) -> None:
    """A gripper of some grams is a body as well."""
    robot = of_size(size, tmp_path)
    found = nearest(robot, robot.apriori, exact(robot, size))
    assert found.distance < 0.1
    masses = np.reshape(robot.body.standard, (3, 10))[:, 9]
    np.testing.assert_allclose(found.bodies[:, 9], masses, rtol=0.1)


@pytest.mark.parametrize("size", [1.0, 3.0, 10.0])
def test_a_heavy_arm_is_not_pulled_to_its_description(size: float, tmp_path: Path) -> None:
    """Bodies that are a tenth heavier than described are possible, at five tons a link as well."""
    robot = of_size(size, tmp_path)
    found = nearest(robot, 1.1 * robot.apriori, exact(robot, size))
    assert found.distance < 0.5


def test_what_turns_with_two_joints_has_no_negative_inertia_or_friction() -> None:
    """The motor of a coupling; without the bound a simulator refuses its armature."""
    robot = load(str(Path(__file__).parents[2] / "samples/arm.toml"))
    at = [i for i, p in enumerate(robot.parameters) if p.name in ("fvm2", "fsm2")]
    theta, errors = robot.apriori.copy(), np.full(len(robot.parameters), 0.01)
    theta[at] = -0.03
    found, moved = uncorrelated(robot, theta, errors)
    assert min(found.axes[name] for name in ("Iam2", "fvm2", "fsm2")) > -1e-6
    np.testing.assert_allclose(moved[at], 3.0, atol=0.01)
