"""Whether the signals belong to one instant, and by how much the torques lead."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from unit.slow_motions import THETA, H, P, least_squares, regression

from scarid_cli.algorithms.regression.rows import Rows, plain, with_delay
from scarid_cli.algorithms.statistics.diagnostics import diagnose
from scarid_cli.arrays import Array, Numbers


def share(rows: Rows) -> float:
    return diagnose(rows, least_squares(rows), P).lag_share


def test_the_neighbours_explain_nothing_where_all_is_well() -> None:
    assert share(regression(8000, coloured=False)) < 0.01


@pytest.mark.parametrize("late", [-10, -3, 3, 10])
def test_the_neighbours_explain_torques_of_another_instant(late: int) -> None:
    rows = regression(8000, coloured=False)
    assert share(plain(rows.W[20:-20], np.roll(rows.y, late, axis=0)[20:-20], H)) > 0.5


@pytest.mark.parametrize(
    "places", [np.arange(0, 8000, 50), np.arange(19)], ids=["no neighbours", "nine unknowns"]
)
def test_too_few_rows_give_no_lag_share(places: Numbers) -> None:
    """Not 0, the best that can be said of a record; nor 1, where nine unknowns fit nine rows."""
    assert np.isnan(share(regression(8000).part(places)))


@given(lead=st.floats(-2e-3, 2e-3))
def test_the_delay_of_the_torques_is_found(lead: float) -> None:
    """Torques of sines, a little early or late; the estimates are as without the delay."""
    t = np.arange(4000) * H

    def regressor(at: Array) -> Array:
        return np.stack([np.sin(at), np.cos(1.7 * at), np.sin(2.3 * at)], axis=1)[:, None, :]

    rows = plain(regressor(t), regressor(t + lead) @ THETA, H)
    fit = least_squares(rows).fit
    for _ in range(3):
        fit = least_squares(with_delay(rows, fit.estimates)).fit
    assert fit.estimates[P] == pytest.approx(lead, abs=2e-6)
    np.testing.assert_allclose(fit.estimates[:P], THETA, atol=1e-4)
