"""Robots: their regressors against mechanics, their descriptions against what is wrong in them."""

from __future__ import annotations

from math import inf
from pathlib import Path

import numpy as np
import pytest

from scarid_cli.algorithms.robots.reading import FOLDER, built_in, load
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault


def motions(joints: int, samples: int = 50) -> Array:
    """Random positions, velocities and accelerations: (3, joints, samples)."""
    return 3.0 * np.random.default_rng(5).standard_normal((3, joints, samples))


# A two-link arm by its masses and lengths: inertia about the own centre of mass, where that is
M1, I1, R1, L1 = 4.0, 0.3, 0.2, 0.5
M2, I2, X2, Y2 = 2.5, 0.1, 0.3, -0.07


def kinetic_energy(q: Array, dq: Array) -> Array:
    """Of both links, for complex arguments too."""
    both, spin = q[0] + q[1], dq[0] + dq[1]
    right = -L1 * np.sin(q[0]) * dq[0] - (X2 * np.sin(both) + Y2 * np.cos(both)) * spin
    up = L1 * np.cos(q[0]) * dq[0] + (X2 * np.cos(both) - Y2 * np.sin(both)) * spin
    first = (I1 + M1 * R1**2) * dq[0] ** 2
    return 0.5 * (first + M2 * (right**2 + up**2) + I2 * spin**2)


def lagrange(q: Array, dq: Array, ddq: Array) -> Array:
    """d/dt (dT/d dq) - dT/dq without algebra: exact to rounding.

    T is quadratic in the velocity, so that its central difference of step 1 is its derivative;
    the others are complex steps.
    """
    step = 1e-30
    torques = []
    for unit in np.eye(2)[:, :, None]:
        later = q + 1j * step * dq, dq + 1j * step * ddq
        ahead = kinetic_energy(later[0], later[1] + unit)
        behind = kinetic_energy(later[0], later[1] - unit)
        force = kinetic_energy(q + 1j * step * unit, dq).imag / step
        torques.append(0.5 * (ahead - behind).imag / step - force)
    return np.array(torques)


def test_planar_arm_obeys_lagrange() -> None:
    q, dq, ddq = motions(joints=2)
    robot = load("scara2")
    theta = {
        "ZZ1R": I1 + M1 * R1**2 + M2 * L1**2,
        "ZZ2": I2 + M2 * (X2**2 + Y2**2),
        "L1MX2": L1 * M2 * X2,
        "L1MY2": L1 * M2 * Y2,
        "Fv1": 0.7,
        "Fv2": 0.2,
        "Fs1": 1.5,
        "Fs2": 0.4,
    }
    friction = np.array([[0.7], [0.2]]) * dq + np.array([[1.5], [0.4]]) * np.sign(dq)
    W = robot.regressor(q, dq, ddq)
    torques = robot.torques(W, np.array([theta[name] for name in robot.names]))
    np.testing.assert_allclose(torques, lagrange(q, dq, ddq) + friction, rtol=1e-11, atol=1e-11)


def test_vertical_arm_is_the_horizontal_one_and_the_slope_of_its_potential_energy() -> None:
    """Hanging at q = 0; L1MX2 is 0.2 m times MX2."""
    q, dq, ddq = motions(joints=2)
    vertical, flat = load("planar2-gravity"), load("scara2")
    mx1r, mx2, g, step = 0.7, 0.4, 9.81, 1e-30
    theta = dict.fromkeys(vertical.names, 0.0) | {"ZZ1R": 1.1, "ZZ2": 0.3, "MX1R": mx1r, "MX2": mx2}
    same = dict.fromkeys(flat.names, 0.0) | {"ZZ1R": 1.1, "ZZ2": 0.3, "L1MX2": 0.2 * mx2}

    def energy(q: Array) -> Array:
        return -g * (mx1r * np.cos(q[0]) + mx2 * np.cos(q[0] + q[1]))

    weight = [energy(q + 1j * step * unit).imag / step for unit in np.eye(2)[:, :, None]]
    torques, inertial = (
        robot.torques(robot.regressor(q, dq, ddq), np.array(list(values.values())))
        for robot, values in ((vertical, theta), (flat, same))
    )
    np.testing.assert_allclose(torques, inertial + weight, rtol=1e-11, atol=1e-11)


def test_single_axis_is_mass_friction_and_offset() -> None:
    q, dq, ddq = motions(joints=1)
    dq[0, 0] = 0.0  # dry friction has no direction at rest
    W = load("emps").regressor(q, dq, ddq)
    columns = [ddq[0], dq[0], np.sign(dq[0]), np.ones(50)]
    np.testing.assert_array_equal(W[:, 0, :], np.column_stack(columns))


@pytest.mark.parametrize("name", built_in())
def test_torques_are_the_regressor_times_the_parameters(name: str) -> None:
    robot = load(name)
    W = robot.regressor(*motions(len(robot.joints)))
    theta = np.random.default_rng(1).standard_normal(len(robot.parameters))
    np.testing.assert_allclose(robot.torques(W, theta), (W @ theta).T, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", built_in())
def test_torques_round_alike_in_any_batch(name: str) -> None:
    robot = load(name)
    motion = motions(len(robot.joints))
    whole = robot.torques(robot.regressor(*motion), robot.apriori)
    halves = [
        robot.torques(robot.regressor(*motion[:, :, rows]), robot.apriori)
        for rows in (np.s_[:7], np.s_[7:])
    ]
    np.testing.assert_array_equal(np.concatenate(halves, axis=1), whole)


# Descriptions


def test_a_priori_values_are_those_of_table_2() -> None:
    robot = load("scara2")
    table = {
        "ZZ1R": 3.42,
        "Fv1": 0.07,
        "Fs1": 0.58,
        "ZZ2": 0.064,
        "L1MX2": 0.131,
        "L1MY2": 0.0,
        "Fv2": 0.015,
        "Fs2": 0.156,
    }
    assert dict(zip(robot.names, robot.apriori, strict=True)) == table
    assert robot.names == list(table)


def test_emps_values_are_the_published_ones() -> None:
    """Janot, Gautier, Brunot 2019."""
    robot = load("emps")
    published = {"M": 95.1089, "Fv": 203.5034, "Fc": 20.3935, "offset": -3.1648}
    assert dict(zip(robot.names, robot.apriori, strict=True)) == published


def test_value_is_found_by_term_and_joint() -> None:
    robot = load("scara2")
    assert robot.value("coulomb", 2) == 0.156
    assert robot.value("offset", 1) == 0.0


def test_unit_follows_the_type_of_joint() -> None:
    revolute, prismatic = load("scara2").joints[0], load("emps").joints[0]
    assert (revolute.unit, revolute.torque_unit) == ("rad", "N m")
    assert (prismatic.unit, prismatic.torque_unit) == ("m", "N")
    assert revolute.torque_limit == inf


def test_file_describes_a_robot_as_a_built_in_does(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text((FOLDER / "emps.toml").read_text("utf-8"), "utf-8")
    mine, theirs = load(str(path)), load("emps")
    assert mine.name == str(path)
    assert (mine.title, mine.joints, mine.parameters, mine.control) == (
        theirs.title,
        theirs.joints,
        theirs.parameters,
        theirs.control,
    )


@pytest.mark.parametrize("name", ["scara3", "nowhere/robot.toml", "../robots/scara2.tml"])
def test_unknown_robot_is_refused_with_the_choice(name: str) -> None:
    with pytest.raises(UsageFault, match=r"unknown robot .*choose emps, planar2-gravity, scara2"):
        load(name)


@pytest.mark.parametrize(
    ("text", "instead", "complaint"),
    [
        ('title = "EMPS, one prismatic axis"', "", "missing 'title'"),
        ("[[joint]]", "[[axis]]", "axis is not of a robot; it has title, joint"),
        ("apriori = 95.1089", "", "apriori"),
        ("apriori = 95.1089", 'apriori = "heavy"', "apriori"),
        ("kp = [1370725.0]", "", "missing 'kp'"),
        ("kp = [1370725.0]", "kp = [1.0, 2.0]", "kp has 2 values for 1 joints"),
        ("position_limit", "position_bound", "position_bound"),
        ('"prismatic"', '"spherical"', "'spherical'; choose revolute or prismatic"),
        ('"viscous"', '"turbulent"', "'turbulent'; choose viscous, coulomb"),
        ("joint = 1", "joint = 2", "on joint 2 of 1"),
        ("joint = 1", "joint = -1", "on joint -1 of 1"),
        ("joint = 1", "", "joint"),
        ("joint = 1", 'joint = "1"', "not a whole number"),
        ("[control]", "[control", "at line"),
        ("prismatic axis", "prismatic axis\xe9", "utf-8"),
    ],
)
def test_bad_description_is_told_in_one_line(
    tmp_path: Path, text: str, instead: str, complaint: str
) -> None:
    good = (FOLDER / "emps.toml").read_text("utf-8")
    assert text in good
    path = tmp_path / "mine.toml"
    path.write_text(good.replace(text, instead), "latin-1")
    with pytest.raises(UsageFault) as refused:
        load(str(path))
    message = str(refused.value)
    assert message.startswith(f"{path}: ")
    assert complaint in message
    assert "\n" not in message


def test_term_of_the_planar_arm_needs_two_joints(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    path.write_text((FOLDER / "emps.toml").read_text("utf-8").replace('"mass"', '"ZZ2"'), "utf-8")
    with pytest.raises(UsageFault, match="ZZ2"):
        load(str(path))


@pytest.mark.parametrize(
    ("text", "instead"),
    [
        ("kp = [1370725.0]", 'kp = "5"'),
        ("kp = [1370725.0]", 'kp = ["5"]'),
        ("kp = [1370725.0]", "kp = [[1.0]]"),
        ("velocity_cutoff = 200.0", 'velocity_cutoff = "x"'),
        ("joint = 1", "joint = 1.0"),
        ("apriori = 95.1089", "apriori = 1" + 400 * "0"),
        ("apriori = 95.1089", 'apriori = 95.1089\n"a\\nb" = 1'),
    ],
)
def test_description_that_cannot_be_used_is_refused_at_once(
    tmp_path: Path, text: str, instead: str
) -> None:
    path = tmp_path / "mine.toml"
    good = (FOLDER / "emps.toml").read_text("utf-8")
    assert text in good
    path.write_text(good.replace(text, instead), "utf-8")
    with pytest.raises(UsageFault) as refused:
        load(str(path))
    assert str(path) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("joint", ["joint = []", 'joint = [{type = "revolute"}]'])
def test_robot_without_parameters_is_refused(tmp_path: Path, joint: str) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f'title = "none"\nparameter = []\n{joint}\n', "utf-8")
    with pytest.raises(UsageFault, match=r"mine\.toml"):
        load(str(path))


def test_term_given_twice_is_refused(tmp_path: Path) -> None:
    """The regressor would add both, and the plant take one."""
    path = tmp_path / "mine.toml"
    good = (FOLDER / "emps.toml").read_text("utf-8")
    path.write_text(good.replace('"coulomb"', '"viscous"'), "utf-8")
    with pytest.raises(UsageFault, match="stands twice"):
        load(str(path))
