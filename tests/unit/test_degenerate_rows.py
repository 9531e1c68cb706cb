"""Rows that leave an estimator nothing to go by: a refusal or an honest answer, no warning."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.regression.estimation import Estimation
from scarid_cli.algorithms.regression.information import NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, plain, rows_of
from scarid_cli.algorithms.robots.reading import load

EMPS = load("emps")


def fast(slowest: float, samples: int = 2000) -> Rows:
    """One axis that reverses, never slower than this [m/s]; without friction that fades."""
    rng = np.random.default_rng(3)
    t = 0.005 * (0.5 + np.arange(samples))
    dq = np.sign(np.sin(t)) * (slowest + 0.2 * np.sin(7.0 * t) ** 2)
    motion = np.zeros((4, 1, samples))
    motion[1], motion[2] = dq, np.cos(7.0 * t)
    W = EMPS.regressor(*motion[:3])
    motion[3] = (W @ EMPS.apriori).T + rng.standard_normal((1, samples))
    return rows_of(EMPS, motion, np.arange(samples), 0.005)


def estimated(name: str, rows: Rows) -> Estimation:
    solver = ESTIMATORS.load(name)().for_robot(EMPS)
    return solver.fit(solver.step(solver.init(np.zeros(rows.W.shape[2])), rows)[0])


@pytest.mark.parametrize("slowest", [0.3, 1.0, 3.0])
def test_friction_that_no_row_shows_is_sought_where_the_slowest_row_has_some(
    slowest: float,
) -> None:
    found = estimated("separable", fast(slowest)).fit
    assert found.estimates[-1] >= 0.99 * slowest / 3.0
    assert np.isfinite(found.unit_covariance).all()


def test_friction_that_cannot_be_told_apart_is_named() -> None:
    with pytest.raises(NotIdentifiableError) as refusal:
        estimated("separable", fast(0.3).part(slice(20)))
    assert refusal.value.added == ("Fst1", "vs1")


def test_total_least_squares_has_no_solution_for_a_torque_orthogonal_to_all_columns() -> None:
    """The nongeneric case of Van Huffel and Vandewalle (1991, section 3.4)."""
    W = np.array([[1.0, 0.8], [1.0, 1.2], [0.0, 0.0]])[:, None, :]
    with pytest.raises(NotIdentifiableError) as refusal:
        estimated("tls", plain(W, np.array([[0.0], [0.0], [1.0]])))
    first, second = refusal.value.direction
    assert first * second < 0.0


@pytest.mark.parametrize("estimator", ["wls", "gls", "irls"])
@pytest.mark.parametrize("torque", [1.0, 1e-305])
def test_weights_of_joints_without_any_residual_are_equal(torque: float, estimator: str) -> None:
    W = np.tile(np.eye(2).reshape(1, 2, 2), (3, 1, 1))
    y = np.array([[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]]) * torque
    found = estimated(estimator, plain(W, y))
    np.testing.assert_allclose(found.fit.estimates, y.mean(axis=0), rtol=1e-9, atol=1e-300)
