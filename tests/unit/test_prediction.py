"""The quality of a prediction against its formulas in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from unit.support import cuts

from scarid_cli.algorithms.inference.prediction import Quality, accumulate, empty
from scarid_cli.arrays import Array

ROWS = 60


def torques(samples: int = ROWS, level: float = 0.0) -> tuple[Array, Array]:
    """Measured ones about a level, and predicted ones that miss them a little."""
    rng = np.random.default_rng(0)
    measured = level + rng.standard_normal(samples)
    return measured, measured + 0.3 * rng.standard_normal(samples)


def quality(measured: Array, predicted: Array) -> Quality:
    return Quality.of(accumulate(empty(), measured, predicted))


@pytest.mark.parametrize("level", [0.0, -3.0, 1e5])
@pytest.mark.parametrize("samples", [2, 1000])
def test_quality_follows_its_formulas(samples: int, level: float) -> None:
    """Eq. 36 and 35; at a level of 1e5, sums of squares less squares of sums would lose r2."""
    measured, predicted = torques(samples, level)
    found, error = quality(measured, predicted), measured - predicted
    about = np.sum((measured - measured.mean()) ** 2)
    assert found.r2 == pytest.approx(1.0 - np.sum(error**2) / about, rel=1e-8)
    assert found.rmse == pytest.approx(np.sqrt(np.mean(error**2)), rel=1e-12)
    relative = 100.0 * np.linalg.norm(error) / np.linalg.norm(measured)
    assert found.relative_error == pytest.approx(relative, rel=1e-12)
    assert found.samples == samples


def test_perfect_prediction() -> None:
    measured, _ = torques()
    assert quality(measured, measured) == Quality(1.0, 0.0, 0.0, ROWS)


def test_prediction_of_the_mean_explains_nothing() -> None:
    measured, _ = torques(level=2.0)
    assert quality(measured, np.full(ROWS, measured.mean())).r2 == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("error", [0.0, 0.3])
@pytest.mark.parametrize("torque", [0.1, -2.0])
def test_constant_torque_has_no_r2(torque: float, error: float) -> None:
    constant = np.full(ROWS, torque)
    found = quality(constant, constant + error)
    assert np.isnan(found.r2)
    assert found.rmse == pytest.approx(error)


def test_no_samples_have_no_quality() -> None:
    found = Quality.of(empty())
    assert np.isnan([found.r2, found.rmse, found.relative_error]).all()
    assert found.samples == 0


@given(chunks=cuts(ROWS), level=st.floats(-1e3, 1e3))
@settings(max_examples=50, deadline=None)
def test_chunks_do_not_change_a_bit(chunks: list[slice], level: float) -> None:
    measured, predicted = torques(level=level)
    sums = empty()
    for chunk in chunks:
        sums = accumulate(sums, measured[chunk], predicted[chunk])
    np.testing.assert_array_equal(sums, accumulate(empty(), measured, predicted))


def test_accumulate_leaves_its_sums_alone() -> None:
    sums = accumulate(empty(), *torques())
    before = sums.copy()
    accumulate(sums, *torques())
    np.testing.assert_array_equal(sums, before)
