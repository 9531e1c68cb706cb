"""Regressors from a URDF and their base parameters."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pytest
from unit.arms import URDF, described_arm, long_chain, seven_axes, turned_axes

from scarid_cli.algorithms.robots.base import independent
from scarid_cli.algorithms.robots.coupled import CoupledInertia
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.robots.rigid import SYMBOLS
from scarid_cli.algorithms.robots.terms import JointMotion, StandardTerm
from scarid_cli.arrays import Array
from scarid_cli.cli.robot import described
from scarid_cli.errors import UsageFault

pinocchio = pytest.importorskip("pinocchio")


@pytest.fixture
def urdf(tmp_path: Path) -> str:
    path = tmp_path / "two.urdf"
    path.write_text(URDF.replace("TYPE", "revolute"))
    return str(path)


def test_the_regressor_gives_the_torques_of_inverse_dynamics(urdf: str) -> None:
    """With the base parameters written out in the URDF's own values; against Pinocchio's RNEA."""
    robot = load(urdf)
    model = pinocchio.buildModelFromUrdf(urdf)
    data = model.createData()
    standard: dict[str, float] = {}
    order = ("m", "mx", "my", "mz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz")
    for i, inertia in enumerate(list(model.inertias)[1:], start=1):
        values = zip(order, inertia.toDynamicParameters(), strict=True)
        standard |= {f"{symbol}{i}": x for symbol, x in values}
    theta = np.array([written_out(p.stands_for or p.name, standard) for p in robot.parameters])
    np.testing.assert_allclose(robot.apriori, theta, atol=1e-12)
    rng = np.random.default_rng(1)
    q, dq, ddq = rng.standard_normal((3, 2, 20))
    torques = robot.torques(robot.regressor(q, dq, ddq), theta)
    for k in range(20):
        expected = pinocchio.rnea(model, data, q[:, k], dq[:, k], ddq[:, k])
        np.testing.assert_allclose(torques[:, k], expected, rtol=1e-5, atol=1e-5)


def written_out(combination: str, values: dict[str, float]) -> float:
    """`Iyy1 + 0.09 m2 - 1 Ia1`, without friction."""
    first, *words = combination.split()
    total = values.get(first, 0.0)
    for sign, factor, name in zip(words[::3], words[1::3], words[2::3], strict=True):
        total += (-1.0 if sign == "-" else 1.0) * float(factor) * values.get(name, 0.0)
    return total


def test_base_parameters_are_those_of_a_planar_arm_and_always_the_same(urdf: str) -> None:
    robot = load(urdf)
    bodies = [p.name for p in robot.parameters if isinstance(p.term, StandardTerm)]
    assert bodies == ["Iyy1", "mx1", "mz1", "Iyy2", "mx2", "mz2"]
    assert robot.parameters[0].stands_for == "Iyy1 + 1 Ia1 + 0.09 m2"
    again = load(urdf)
    assert [p.stands_for for p in again.parameters] == [p.stands_for for p in robot.parameters]
    motion = np.random.default_rng(2).standard_normal((3, 2, 100))
    W = robot.regressor(*motion).reshape(-1, len(robot.parameters))
    assert np.linalg.matrix_rank(W) == len(robot.parameters)


@pytest.mark.parametrize("digits", [15, 5, 4])
def test_rounded_angles_of_a_urdf_add_no_parameters(digits: int, tmp_path: Path) -> None:
    """Seven axes at right angles have 43 of links, 5 of motors, and 3 of friction each."""
    right, half = np.pi / 2.0, np.pi
    turns = [(0, 0, 0), *[(right, 0, half)] * 2, (right, 0, 0), (-right, half, 0), (right, 0, 0)]
    rounded = [[round(x, digits) for x in turn] for turn in (*turns, (-right, half, 0))]
    path = tmp_path / "seven.urdf"
    path.write_text(turned_axes(rounded))
    parameters = load(str(path)).parameters
    assert sum(isinstance(p.term, StandardTerm) for p in parameters) == 43
    assert len(parameters) == 43 + 5 + 3 * 7


@pytest.mark.parametrize("lever", [0.3, 0.03, 0.003])
def test_the_masses_of_a_tiny_arm_count(lever: float, tmp_path: Path) -> None:
    """On a lever of millimetres a mass has next to no column, and next to no inertia beside it."""
    path = tmp_path / "tiny.urdf"
    path.write_text(seven_axes(axes=4).replace('xyz="0 0 0.2"', f'xyz="{lever} 0 {lever}"'))
    robot = load(str(path))
    assert robot.body
    motion = np.random.default_rng(1).uniform(-3.0, 3.0, (3, 4, 50))
    W, columns = robot.regressor(*motion), robot.body.columns(*motion)
    names = [f"{symbol}{i}" for i in robot.body.link_numbers for symbol in SYMBOLS]
    combined = np.zeros_like(columns)
    for k, parameter in enumerate(robot.parameters):
        for name, factor in parameter.parts:
            if name in names:
                combined[..., names.index(name)] += factor * W[..., k]
    np.testing.assert_allclose(combined, columns, atol=2e-5)


def test_dependent_columns_are_counted_to_those_before_them() -> None:
    W = np.random.default_rng(0).standard_normal((50, 5))
    W[:, 1] = 0.0
    W[:, 3] = 2.0 * W[:, 0] - 0.5 * W[:, 2]
    kept, parts = independent(W)
    assert kept == [0, 2, 4]
    np.testing.assert_allclose(parts[:, 3], [2.0, -0.5, 0.0], atol=1e-12)
    np.testing.assert_allclose(W[:, kept] @ parts[:, [1, 3]], W[:, [1, 3]], atol=1e-12)


def test_of_columns_that_are_all_zero_none_is_kept() -> None:
    kept, parts = independent(np.zeros((50, 3)))
    assert (kept, parts.shape) == ([], (0, 3))


def one_by_one(W: Array) -> list[int]:
    """The columns that are independent of those before them, each tried by itself."""
    kept: list[int] = []
    basis = np.empty((len(W), 0))
    for i, column in enumerate(W.T):
        rest = column / (np.linalg.norm(column) or 1.0)
        for _ in range(2):
            rest = rest - basis @ (basis.T @ rest)
        if np.linalg.norm(rest) > 1e-8:
            basis = np.column_stack((basis, rest / np.linalg.norm(rest)))
            kept.append(i)
    return kept


def test_columns_projected_together_are_those_projected_one_by_one() -> None:
    rng = np.random.default_rng(3)
    W = rng.standard_normal((400, 150)) * rng.uniform(1e-3, 1e3, 150)
    for i in (0, 7, 31, 32, 33, 64, 90, 149):
        W[:, i] = W[:, :i] @ rng.standard_normal(i)  # the first is zero
    kept, parts = independent(W)
    assert kept == one_by_one(W)
    assert len(kept) == 142
    np.testing.assert_allclose(W[:, kept] @ parts[:, 90], W[:, 90], rtol=1e-7)


def test_the_base_parameters_of_forty_joints_give_the_torques_of_all(tmp_path: Path) -> None:
    """Against Pinocchio's inverse dynamics, with the masses and inertias of the URDF."""
    path = tmp_path / "chain.urdf"
    path.write_text(long_chain(40))
    robot = load(str(path))
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    q, dq, ddq = 0.1 * np.random.default_rng(1).standard_normal((3, 40, 3))
    W = robot.regressor(q, dq, ddq)
    torques = robot.torques(W, robot.apriori)
    for k in range(3):
        expected = pinocchio.rnea(model, data, q[:, k], dq[:, k], ddq[:, k])
        np.testing.assert_allclose(torques[:, k], expected, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("kind", ["urdf", "toml"])
def test_a_robot_of_a_thousand_joints_is_refused(kind: str, tmp_path: Path) -> None:
    path = tmp_path / f"chain.{kind}"
    joint = "[[joint]]\ntype = 'revolute'\n"
    parameter = "[[parameter]]\nname='a'\nunit=''\napriori=0\nterm='viscous'\njoint=1\n"
    lines = f"title = 'chain'\n{joint * 1000}{parameter}"
    path.write_text(long_chain(1000) if kind == "urdf" else lines)
    with pytest.raises(UsageFault, match="1000 moving joints; at most 100"):
        load(str(path))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("<robot", "not a URDF"),
        (URDF.replace("TYPE", "floating"), "only revolute, continuous and prismatic"),
    ],
    ids=["broken", "floating"],
)
def test_what_is_no_arm_is_refused(content: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "x.urdf"
    path.write_text(content)
    with pytest.raises(UsageFault, match=message):
        load(str(path))


def test_a_prismatic_joint_is_known_by_its_type(tmp_path: Path) -> None:
    path = tmp_path / "x.urdf"
    path.write_text(URDF.replace("TYPE", "prismatic"))
    assert [joint.type for joint in load(str(path)).joints] == ["revolute", "prismatic"]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("[[joint]]", "1 tables [[joint]] for the 2 axes of"),
        ("[[joint]]\n[[joint]]\nterms = ['magic']", "an axis has no term 'magic'; choose viscous"),
        ("[[coupling]]\njoints = [1, 3]", "joints 1 and 3 cannot be coupled"),
        ("[[joint]]\nname = 'a'\n[[joint]]", "some joints have a name"),
        (
            "[[joint]]\nname = 'b'\n[[joint]]\nname = 'a'",
            "no joints b, a in this order; it has a, b",
        ),
        ("[[joint]]\nmass = 3.0\n[[joint]]", "mass is not a key of [[joint]]; its keys are type"),
        ("gravity = [0.0, 9.81]", "not a list of 3 numbers"),
        ("joint = [1, 2]", "joint is 1, not a table"),
        ("coupling = 3", "coupling is 3, not tables [[coupling]]"),
        ("[[coupling]]", "missing 'joints'"),
        ("log = 3", "log is 3, not a table"),
        ("[log]\ntorques = 'amps'", "torques 'amps'; choose joint or motor or current"),
        ("[log]\nrate = -1.0", "rate is not positive"),
        ("[log]\n[[joint]]\ngear_ratio = 0.0\n[[joint]]", "gear_ratio is 0"),
        ("", "no such file"),
    ],
    ids=lambda value: value.replace("\n", " ") if "[" in value else "",
)
def test_a_description_that_does_not_fit_is_refused(
    lines: str, message: str, urdf: str, tmp_path: Path
) -> None:
    path = tmp_path / "robot.toml"
    place = urdf if lines else "nowhere.urdf"
    path.write_text(f"title = 'two'\nurdf = '{place}'\n{lines}\n")
    with pytest.raises(UsageFault, match=re.escape(message)):
        load(str(path))


def test_a_check_writes_the_base_parameters_out(urdf: str) -> None:
    lines = list(described(load(urdf)))
    assert "freedom     2 joints, 13 parameters" in lines
    assert "controller  none; `simulate` uses its default" in lines
    assert "  1  revolute   position -3 to 3 rad, velocity 9 rad/s, torque 9 N m" in lines
    assert "  Iyy1  kg m2      0.31  = Iyy1 + 1 Ia1 + 0.09 m2" in lines
    assert "  mx2   kg m       0.1" in lines


def test_a_joint_without_end_is_an_angle(urdf: str, tmp_path: Path) -> None:
    path = tmp_path / "turning.urdf"
    path.write_text(URDF.replace("TYPE", "continuous"))
    turning, limited = load(str(path)), load(urdf)
    motion = np.random.default_rng(0).standard_normal((3, 2, 5))
    np.testing.assert_array_equal(turning.regressor(*motion), limited.regressor(*motion))
    assert (turning.joints[1].lower, turning.joints[1].upper) == (-np.inf, np.inf)


def test_joints_without_an_entry_are_locked(urdf: str, tmp_path: Path) -> None:
    """Joint a alone: link two turns with it as one body, by Steiner's theorem."""
    lines = "[[joint]]\nname = 'a'\nterms = { viscous = 2.0 }"
    robot = described_arm(urdf, tmp_path, lines)
    values = dict(zip(robot.names, robot.apriori, strict=True))
    assert list(values) == ["Iyy1", "mx1", "mz1", "fv1"]
    assert values["fv1"] == 2.0
    own = 0.2 + 2.0 * 0.1**2  # link one about its joint
    assert values["Iyy1"] == pytest.approx(own + 0.02 + (0.4**2 + 0.05**2))
    assert values["mx1"] == pytest.approx(2.0 * 0.1 + 0.4)


def test_gravity_pulls_where_the_description_says(urdf: str, tmp_path: Path) -> None:
    """Along y, the axis of both joints: nothing is felt at rest."""
    q = np.array([[0.3], [0.4]])
    rest = np.zeros((2, 1))
    upright = described_arm(urdf, tmp_path, "")
    lying = described_arm(urdf, tmp_path, "gravity = [0.0, 9.81, 0.0]")
    assert np.abs(upright.regressor(q, rest, rest)[:, :, :6]).max() > 1.0
    bodies = [i for i, p in enumerate(lying.parameters) if isinstance(p.term, StandardTerm)]
    np.testing.assert_allclose(lying.regressor(q, rest, rest)[:, :, bodies], 0.0, atol=1e-12)


def test_friction_may_differ_between_directions(urdf: str, tmp_path: Path) -> None:
    terms = "terms = ['viscous-forward', 'viscous-backward', 'coulomb-forward', 'coulomb-backward']"
    robot = described_arm(urdf, tmp_path, f"[[joint]]\n{terms}\n[[joint]]\nterms = []")
    dq = np.array([[2.0, -3.0], [0.0, 0.0]])
    W = robot.regressor(np.zeros((2, 2)), dq, np.zeros((2, 2)))
    columns = {name: W[:, 0, i].tolist() for i, name in enumerate(robot.names)}
    friction = {name: column for name, column in columns.items() if name[-1] in "+-"}
    assert friction == {
        "fv1+": [2.0, 0.0],
        "fv1-": [0.0, -3.0],
        "fs1+": [1.0, 0.0],
        "fs1-": [0.0, -1.0],
    }


def test_a_coupled_motor_is_felt_by_both_joints(urdf: str, tmp_path: Path) -> None:
    """Virtual work: motor 2 turns by N (k q1 + q2); its torques are the slopes of that angle."""
    N, k = 30.0, 0.5
    robot = described_arm(
        urdf,
        tmp_path,
        f"[[joint]]\n[[joint]]\ngear_ratio = {N}\n[[coupling]]\njoints = [1, 2]\nratio = {k * N}",
    )
    dq, ddq = np.random.default_rng(0).standard_normal((2, 2, 9))
    W = robot.regressor(np.zeros((2, 9)), dq, ddq)
    column = {name: W[:, :, i].T for i, name in enumerate(robot.names)}
    slopes = np.array([[k], [1.0]])
    angle_rate = k * dq[0] + dq[1]
    np.testing.assert_allclose(column["fsm2"], slopes * np.sign(angle_rate))
    own = np.array([k * k * dq[0], dq[1]])  # what the axes' own columns have
    np.testing.assert_allclose(column["fvm2"], slopes * angle_rate - own)
    both = CoupledInertia(joint=1, other=2, ratio=k).column(JointMotion(dq, dq, ddq))
    own = np.array([k * k * ddq[0], ddq[1]])
    np.testing.assert_allclose([both[0], both[1]], slopes * (k * ddq[0] + ddq[1]) - own)


def test_the_page_on_robots_shows_the_sample() -> None:
    """And the sample is one that can be used: hanging links, a motor that turns with both."""
    root = Path(__file__).parents[2]
    sample = (root / "samples" / "arm.toml").read_text("utf-8")
    _, described_in_it = sample.split("\n", 1)
    assert described_in_it in (root / "docs" / "robots.md").read_text("utf-8")
    robot = load(str(root / "samples" / "arm.toml"))
    assert robot.log is not None
    assert robot.log.ratios == ((80.0, 0.0), (50.0, -50.0))
    values = dict(zip(robot.names, robot.apriori, strict=True))
    upper, lower = 0.04 + 3.2 * 0.18**2, 0.012 + 1.4 * 0.15**2 + 0.0002 + 0.3 * 0.3**2
    assert values["Iyy1"] == pytest.approx(upper + 0.1 + 1.7 * 0.4**2)
    assert values["Iyy2"] == pytest.approx(lower)
    assert values["mz2"] == pytest.approx(-1.4 * 0.15 - 0.3 * 0.3)


def test_without_pinocchio_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF.replace("TYPE", "revolute"))
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    with pytest.raises(UsageFault, match=r"arm\.urdf: .*pip install 'scarid\[urdf\]'"):
        load(str(path))
