"""The terms of the regressor against mechanics."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from scarid_cli.algorithms.robots.reading import built_in, load
from scarid_cli.algorithms.robots.terms import (
    AXIS_TERMS,
    AxisTerm,
    Coulomb,
    CoulombBackward,
    CoulombForward,
    JointMotion,
    Mass,
    Offset,
    Quadratic,
    Stribeck,
    Viscous,
    ViscousBackward,
    ViscousForward,
)
from scarid_cli.arrays import Array


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
    dq[0, 0] = 0.0  # Coulomb friction has no direction at rest
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


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        (Viscous(2), lambda dq: dq),
        (Coulomb(2), np.sign),
        (Coulomb(2, velocity=0.3), lambda dq: np.tanh(dq / 0.3)),
        (Stribeck(2, velocity=0.3), lambda dq: np.sign(dq) * np.exp(-((dq / 0.3) ** 2))),
        (Quadratic(2), lambda dq: np.sign(dq) * dq**2),
        (ViscousForward(2), lambda dq: dq * (dq > 0.0)),
        (ViscousBackward(2), lambda dq: dq * (dq < 0.0)),
        (CoulombForward(2), lambda dq: np.heaviside(dq, 0.0)),
        (CoulombBackward(2), lambda dq: -np.heaviside(-dq, 0.0)),
        (Offset(2), np.ones_like),
        (Mass(2), None),
    ],
    ids=lambda value: str(value) if isinstance(value, AxisTerm) else "",
)
def test_a_term_of_an_axis_is_its_formula_on_its_joint_alone(
    term: AxisTerm, expected: Callable[[Array], Array] | None
) -> None:
    motion = motions(joints=3)
    motion[1, 1, 0] = 0.0
    column = term.column(JointMotion(*motion))
    assert list(column) == [1]
    _, dq, ddq = motion[:, 1]
    np.testing.assert_allclose(column[1], ddq if expected is None else expected(dq), atol=1e-15)


def test_every_term_of_an_axis_is_held_to_its_formula() -> None:
    """In the test above; a new one belongs there."""
    (marker,) = test_a_term_of_an_axis_is_its_formula_on_its_joint_alone.pytestmark  # type: ignore[attr-defined]
    assert {type(term) for term, _ in marker.args[1]} == set(AXIS_TERMS.values())
