"""The open loop of `validate --rollout`, against another integrator."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from scarid_cli.algorithms.plants.loop import IndefiniteError
from scarid_cli.algorithms.plants.rollout import OpenLoop
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

H = 0.002
T = np.arange(51) * H


def acceleration(robot: Robot, q: Array, dq: Array, tau: Array) -> Array:
    """From the torques of the regressor alone."""

    def torques(ddq: Array) -> Array:
        W = robot.regressor(q[:, None], dq[:, None], ddq[:, None])
        return robot.torques(W, robot.apriori)[:, 0]

    rest = torques(np.zeros_like(q))
    M = np.array([torques(unit) - rest for unit in np.eye(len(q))]).T
    return np.linalg.solve(M, tau - rest)


@pytest.mark.parametrize("name", ["scara2", "planar2-gravity", "samples/arm.toml", "emps"])
def test_the_motion_is_that_of_scipys_integrator(name: str) -> None:
    """While no joint stops: Coulomb friction is sign(dq)."""
    robot = load(name)
    n = len(robot.joints)
    q, dq = np.linspace(-0.5, 0.4, n), np.full(n, 1.5)
    size = robot.torques(robot.regressor(q[:, None], dq[:, None], np.zeros((n, 1))), robot.apriori)
    torques = size * (1.0 + 0.2 * np.sin(20.0 * T + np.arange(n)[:, None]))

    def rate(t: float, x: Array) -> Array:
        tau = np.array([np.interp(t, T, row) for row in torques])
        return np.concatenate((x[n:], acceleration(robot, x[:n], x[n:], tau)))

    expected = solve_ivp(rate, (0.0, T[-1]), [*q, *dq], t_eval=T, rtol=1e-9, atol=1e-9)
    assert (expected.y[n:] > 0.0).all()
    found = OpenLoop(robot, robot.apriori).positions(q, dq, torques, H)
    # Torques are held at the mean of both ends of each step.
    np.testing.assert_allclose(found, expected.y[:n], atol=2e-5)


def test_friction_holds_a_joint() -> None:
    robot = load("emps")
    loop = OpenLoop(robot, robot.apriori)
    friction = robot.value("coulomb", 1)
    offset = robot.value("offset", 1)
    still = loop.positions(np.zeros(1), np.zeros(1), offset + np.full((1, 51), 0.9 * friction), H)
    np.testing.assert_array_equal(still, 0.0)
    moved = loop.positions(np.zeros(1), np.zeros(1), offset + np.full((1, 51), 2.0 * friction), H)
    assert moved[0, -1] > 5e-4


def test_a_negative_mass_is_refused() -> None:
    robot = load("emps")
    theta = robot.apriori.copy()
    theta[robot.names.index("M")] = -1.0
    with pytest.raises(IndefiniteError):
        OpenLoop(robot, theta).positions(np.zeros(1), np.ones(1), np.zeros((1, 51)), H)
