"""Estimates that rigid bodies can have, and their intervals."""

from __future__ import annotations

import numpy as np
import pytest
from unit.arms import URDF

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load

pytest.importorskip("pinocchio")
pytest.importorskip("cvxpy")

from scarid_cli.algorithms.robots.possible import Possible, possible

QUANTILE = 2.0


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    folder = tmp_path_factory.mktemp("arm")
    (folder / "arm.urdf").write_text(URDF.replace("TYPE", "revolute"))
    terms = "terms = { viscous = 2.0, coulomb = 0.5 }"
    text = f"title = 'arm'\nurdf = 'arm.urdf'\n[[joint]]\n{terms}\n[[joint]]\n{terms}\n"
    (folder / "arm.toml").write_text(text)
    return load(str(folder / "arm.toml"))


def found(robot: Robot, estimates: np.ndarray, errors: np.ndarray) -> Possible:
    return possible(robot, estimates, np.diag(errors**2), (), QUANTILE)


def test_the_intervals_are_those_of_the_errors_where_the_bodies_are_possible(arm: Robot) -> None:
    errors = np.maximum(1e-3 * np.abs(arm.apriori), 1e-7)
    same = found(arm, arm.apriori, errors)
    assert same.distance < 0.05
    half = 0.5 * (same.high - same.low)
    friction = np.array([name[:2] in ("fv", "fs") for name in arm.names])
    np.testing.assert_allclose(half[friction], QUANTILE * errors[friction], rtol=0.02)
    assert np.all(half <= QUANTILE * errors * 1.02)


def test_a_negative_friction_is_zero_and_its_interval_ends_there(arm: Robot) -> None:
    """The ends in closed form: one parameter, whose estimate is half an error below zero."""
    errors = np.maximum(1e-3 * np.abs(arm.apriori), 1e-7)
    i = next(k for k, name in enumerate(arm.names) if name.startswith("fv"))
    estimates = arm.apriori.copy()
    errors[i] = 0.2
    estimates[i] = -0.5 * errors[i]
    zero = found(arm, estimates, errors)
    assert zero.distance == pytest.approx(0.5, abs=0.05)
    assert zero.estimates[i] == pytest.approx(0.0, abs=1e-6)
    assert zero.low[i] == pytest.approx(0.0, abs=1e-6)
    expected = errors[i] * (np.hypot(0.5, QUANTILE) - 0.5)
    assert zero.high[i] == pytest.approx(expected, rel=0.01)
    assert zero.reached


def test_estimates_far_from_all_bodies_are_told(arm: Robot) -> None:
    errors = np.maximum(1e-3 * np.abs(arm.apriori), 1e-7)
    i = next(k for k, name in enumerate(arm.names) if name.startswith("fv"))
    estimates = arm.apriori.copy()
    estimates[i] = -30.0 * errors[i]
    assert not found(arm, estimates, errors).reached
