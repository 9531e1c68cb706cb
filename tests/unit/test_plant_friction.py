"""Coulomb friction of the simulated robot: joints stick, slide, stop and are dragged along."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from unit.plants import (
    ARM,
    RATE,
    closed_loop,
    free,
    inertia,
    mass_matrix,
    push,
    pushed,
)
from unit.support import adjusted

from scarid_cli.arrays import Array

AXIS = adjusted("emps", Fv=0.0, offset=0.0)
MASS, COULOMB = AXIS.value("mass", 1), AXIS.value("coulomb", 1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_joint_stays_where_it_is_below_the_coulomb_friction(sign: float) -> None:
    loop = pushed(AXIS, 0.999 * COULOMB)
    still = np.zeros((1, 3000))
    _, log = loop.step(loop.init(np.array([0.1])), np.full((1, 3000), sign * 1e3), still, still)
    np.testing.assert_array_equal(log.tau_true, sign * 0.999 * COULOMB)
    np.testing.assert_array_equal(log.q_true, 0.1)
    np.testing.assert_array_equal(log.dq_true, 0.0)
    np.testing.assert_array_equal(log.ddq_true, 0.0)


@pytest.mark.parametrize("excess", [0.001, 0.5])
def test_joint_accelerates_with_what_exceeds_the_coulomb_friction(excess: float) -> None:
    log = push(pushed(AXIS, (1.0 + excess) * COULOMB), 3000)
    t, ddq = np.arange(3000) / RATE, excess * COULOMB / MASS
    np.testing.assert_allclose(log.ddq_true[0], ddq, rtol=1e-10)
    np.testing.assert_allclose(log.q_true[0], 0.5 * ddq * t**2, rtol=1e-10)


@pytest.mark.parametrize("dq", [0.1, -0.37])
def test_sliding_joint_stops_where_friction_has_eaten_its_energy(dq: float) -> None:
    """After m v / Fc, at m v^2 / (2 Fc); there it stays."""
    log = free(closed_loop(AXIS), [0.0], [dq], 3000)
    stop = MASS * abs(dq) / COULOMB
    tick = int(np.argmax(log.dq_true[0] == 0.0))
    assert stop <= tick / RATE <= stop + 1.0 / RATE
    np.testing.assert_array_equal(log.dq_true[0, tick:], 0.0)
    np.testing.assert_array_equal(log.q_true[0, tick:], log.q_true[0, tick])
    assert log.q_true[0, -1] == pytest.approx(np.sign(dq) * 0.5 * stop * abs(dq), rel=1e-11)


@pytest.mark.parametrize(("share", "slides"), [(0.99, False), (1.01, True)])
def test_joint_at_rest_is_dragged_along_beyond_its_coulomb_friction(
    share: float, *, slides: bool
) -> None:
    """Joint 1 accelerates; M12 of its acceleration is what joint 2 has to hold."""
    robot = adjusted("scara2", Fv1=0.0, Fv2=0.0, Fs1=0.0)
    M = inertia(robot, np.zeros((2, 1)))[0]
    torque = share * robot.value("coulomb", 2) / M[1, 0] * M[0, 0]
    log = push(pushed(robot, torque, 0.0), 2)
    assert log.ddq_true[0, 0] > 0.0
    assert (log.ddq_true[1, 0] != 0.0) == slides


def complementary(q2: float, tau: Array, coulomb: Array) -> Array:
    """The accelerations from rest, by trying all nine ways to stick and slide: one is right."""
    M, found = mass_matrix(q2), []
    for way in itertools.product((-1.0, 0.0, 1.0), repeat=2):
        s, a = np.array(way), np.zeros(2)
        slides = np.flatnonzero(s)
        if len(slides):
            a[slides] = np.linalg.solve(M[np.ix_(slides, slides)], (tau - coulomb * s)[slides])
        holding = tau - M @ a
        if np.all(np.where(s == 0.0, np.abs(holding) <= coulomb, a * s > 0.0)):
            found.append(a)
    assert len(found) == 1
    return found[0]


def test_both_joints_leave_rest_as_complementarity_says() -> None:
    rng = np.random.default_rng(0)
    coulomb = np.array([0.58, 0.156])
    robot = adjusted("scara2", L1MY2=ARM[3], Fs1=coulomb[0], Fs2=coulomb[1])
    for _ in range(300):
        q2, tau = rng.uniform(-1.5, 1.5), rng.uniform(-1.0, 1.0, 2) * [3.0, 0.8]
        loop, zero = pushed(robot, *np.abs(tau)), np.zeros((2, 1))
        start = np.array([0.0, q2])
        _, log = loop.step(loop.init(start), (start + 1e3 * np.sign(tau))[:, None], zero, zero)
        np.testing.assert_allclose(log.tau_true[:, 0], tau)
        expected = complementary(q2, tau, coulomb)
        np.testing.assert_allclose(log.ddq_true[:, 0], expected, atol=1e-10)
