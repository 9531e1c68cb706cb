"""The nearest body to ten inertial parameters, against a semidefinite programme."""

from __future__ import annotations

import cvxpy
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.changes.body import HELD, LIGHT, nearest
from scarid_cli.algorithms.robots.physical import LENGTH, pseudo_inertia
from scarid_cli.stages.models.controllers import settings as lines_of

SIZES = np.array([*np.full(6, LENGTH**2), *np.full(3, LENGTH), 1.0])


def drawn(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """An estimate of a body whose errors are as large as its inertia, and the factor."""
    rng = np.random.default_rng(seed)
    mass, centre = rng.uniform(0.2, 5.0), rng.uniform(-0.1, 0.1, 3)
    half = 0.05 * rng.standard_normal((3, 3))
    J = np.empty((4, 4))
    J[:3, :3] = mass * (half @ half.T + np.outer(centre, centre))
    J[:3, 3] = J[3, :3] = mass * centre
    J[3, 3] = mass
    inertia = np.trace(J[:3, :3]) * np.eye(3) - J[:3, :3]
    phi = np.array([*inertia[np.triu_indices(3)], *J[:3, 3], mass])
    errors = np.array([*(np.full(6, 0.05 * mass * 0.05)), 0.01, 0.01, 0.01, 0.02])
    mix = np.eye(10) + 0.2 * rng.standard_normal((10, 10))
    factor = mix / errors
    return phi + np.linalg.solve(factor, rng.standard_normal(10)), factor


def by_programme(phi: np.ndarray, factor: np.ndarray) -> float:
    x = cvxpy.Variable(10)
    inertia = cvxpy.bmat([[x[0], x[1], x[2]], [x[1], x[3], x[4]], [x[2], x[4], x[5]]])
    upper = 0.5 * (x[0] + x[3] + x[5]) * np.eye(3) - inertia
    moments = cvxpy.reshape(x[6:9], (3, 1), order="C")
    J = cvxpy.bmat([[upper, moments], [moments.T, cvxpy.reshape(x[9], (1, 1), order="C")]])
    problem = cvxpy.Problem(cvxpy.Minimize(cvxpy.sum_squares(factor @ (x - phi))), [J >> 0])
    return float(np.sqrt(problem.solve(solver=cvxpy.CLARABEL)))


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6))
def test_no_body_is_nearer(seed: int) -> None:
    phi, factor = drawn(seed)
    body, away = nearest(phi, factor)
    assert np.linalg.eigvalsh(pseudo_inertia(body))[0] >= -1e-12
    # The barrier's last weight leaves 8e-7 of the squared distance, and the programme as much.
    assert away**2 == pytest.approx(by_programme(phi, factor) ** 2, rel=1e-4, abs=2e-6)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10**6), st.sets(st.integers(0, 9), min_size=1, max_size=9))
def test_what_is_told_of_a_body_is_possible(seed: int, told: set[int]) -> None:
    """Some parameters of a body are told, nearly without error, and nothing of the others."""
    phi, factor = drawn(seed)
    true, _ = nearest(phi, factor)
    known = np.zeros(10)
    known[list(told)] = true[list(told)]
    body, away = nearest(known, np.eye(10)[list(told)] * 1e4)
    assert np.linalg.eigvalsh(pseudo_inertia(body))[0] > -1e-12
    # The true body is nearer than this: what is not told is held where it is, if weakly.
    held = (true - known)[list(set(range(10)) - told)] / SIZES[list(set(range(10)) - told)]
    assert away < HELD * np.linalg.norm(held) / max(known[9], LIGHT) + 1e-3


def test_controllers_get_their_units() -> None:
    values = np.array([2.0, 0.01, -0.02, 0.05, 0.01, 0.0, 0.0, 0.02, 0.0, 0.025])
    lines = lines_of(values, values)
    assert lines["UR"] == "set_target_payload(2, [0.01, -0.02, 0.05], [0.01, 0.02, 0.025, 0, 0, 0])"
    assert lines["Franka"] == (
        "robot.setLoad(2, {0.01, -0.02, 0.05}, {0.01, 0, 0, 0, 0.02, 0, 0, 0, 0.025})"
    )
    assert lines["KUKA"] == (
        "{M 2, CM {X 10, Y -20, Z 50, A 0, B 0, C 0}, J {X 0.01, Y 0.02, Z 0.025}}"
    )
    assert (
        "set_target_payload(2, [0.01, -0.02, 0.05])"
        in lines_of(np.append(values[:9], np.nan), values).values()
    )
    assert not lines_of(np.append(np.nan, values[1:]), values)
    vague = lines_of(values, np.append(values[:9], -0.001))
    assert vague["UR"] == "set_target_payload(2, [0.01, -0.02, 0.05])"
