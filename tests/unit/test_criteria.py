"""The criteria by which experiments are optimised, beside their textbook definitions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from scarid_cli.algorithms.design import criteria
from scarid_cli.arrays import Array


def matrices(count: int = 6) -> Array:
    """A symmetric positive definite matrix whose eigenvalues differ."""
    A = np.random.default_rng(2).standard_normal((40, count)) * np.geomspace(1.0, 30.0, count)
    return A.T @ A


SCALES = np.array([1.0, 2.0, 0.5, 1.5, 3.0, 0.7])
CRITERIA: dict[str, Callable[[Array], tuple[float, Array]]] = {
    "d": criteria.determinant,
    "c": lambda M: criteria.condition(M, np.eye(6)),
    "scaled-c": lambda M: criteria.scaled_condition(M, np.eye(6)),
    "a": lambda M: criteria.goal("a", np.diag(SCALES**2)).of(M, M)[::2],  # type: ignore[return-value]
    "d of some": lambda M: criteria.goal("d", np.diag(SCALES**2), (1, 4)).of(M, M)[::2],  # type: ignore[return-value]
    "a of some": lambda M: criteria.goal("a", np.diag(SCALES**2), (1, 4)).of(M, M)[::2],  # type: ignore[return-value]
}


@pytest.mark.parametrize("name", CRITERIA)
def test_the_gradient_of_a_criterion_is_its_slope(name: str) -> None:
    M = matrices()
    _, found = CRITERIA[name](M)
    for i in range(len(M)):
        for j in range(i + 1):
            step = np.zeros_like(M)
            step[i, j] = step[j, i] = 1e-5 * np.sqrt(M[i, i] * M[j, j])
            ahead, behind = CRITERIA[name](M + step)[0], CRITERIA[name](M - step)[0]
            assert (found * step).sum() == pytest.approx((ahead - behind) / 2.0, rel=1e-4, abs=1e-9)


def test_criteria_are_what_textbooks_say() -> None:
    M = matrices()
    covariance = np.linalg.inv(M)
    some = np.ix_((1, 4), (1, 4))
    values = {name: criterion(M)[0] for name, criterion in CRITERIA.items()}
    assert values["d"] == pytest.approx(-np.log(np.linalg.det(M)) / 12.0)
    assert values["d of some"] == pytest.approx(np.log(np.linalg.det(covariance[some])) / 4.0)
    scaled = np.diag(covariance) * SCALES**2
    assert values["a"] == pytest.approx(np.log(scaled.mean()) / 2.0)
    assert values["a of some"] == pytest.approx(np.log(scaled[[1, 4]].mean()) / 2.0)
    lengths = np.sqrt(np.diag(M))
    for name, matrix in (("c", M), ("scaled-c", M / np.outer(lengths, lengths))):
        exact = 0.5 * np.log(np.linalg.cond(matrix))
        assert exact <= values[name] <= exact + np.log(6.0) / criteria.POWER


def test_what_no_motion_excites_has_no_say_in_the_condition_number() -> None:
    typical = np.diag([1.0, 4.0, 1e-12])
    M = np.diag([9.0, 1.0, 1e-10])
    value, slope = criteria.goal("c", typical).of(M, M)[:2]
    assert value == pytest.approx(np.log(3.0), rel=1e-6)
    assert slope[2, 2] == pytest.approx(0.0, abs=1e-12)


def test_a_motion_far_beyond_its_limits_has_a_value() -> None:
    """A trial of the line search, whose smallest eigenvalue is rounding."""
    M = np.diag([1e20, 1.0, -1.0])
    value, slope = criteria.condition(M, np.eye(3))
    assert np.isfinite(value)
    assert np.isfinite(slope).all()
