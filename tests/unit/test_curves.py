"""Curves that are linear in coefficients: their functions, and the bounds of their values."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline

from scarid_cli.algorithms.trajectories.curve import Basis, random_curve
from scarid_cli.algorithms.trajectories.fourier import FourierBasis
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.spline import SplineBasis

BASES = [SplineBasis(6.0, 7), FourierBasis(6.0, 3)]
every_basis = pytest.mark.parametrize("basis", BASES, ids=["spline", "fourier"])


@every_basis
def test_the_functions_of_a_basis_have_a_peak_acceleration_of_1_and_start_and_end_at_rest(
    basis: Basis,
) -> None:
    t = np.linspace(0.0, basis.duration, 4001)
    for order in range(4):
        values, slopes = basis.values(t, order), basis.values(t, order + 1)
        differences = (values[:, 2:] - values[:, :-2]) / (2.0 * t[1])
        np.testing.assert_allclose(differences, slopes[:, 1:-1], atol=0.02 * np.abs(slopes).max())
        if order < 3:
            assert (values[:, [0, -1]] == 0.0).all()
    assert np.abs(basis.values(t, 2)).max(axis=1) == pytest.approx(1.0, rel=1e-3)


def test_splines_are_those_of_scipy() -> None:
    t = np.linspace(0.0, 6.0, 50)
    knots = np.concatenate((np.zeros(5), np.linspace(0.0, 6.0, 8), np.full(5, 6.0)))
    theirs = BSpline.design_matrix(t, knots, 5).toarray().T[3:-3]
    ours = SplineBasis(6.0, 7).values(t, 0)
    np.testing.assert_allclose(ours, theirs * (ours.max(axis=1) / theirs.max(axis=1))[:, None])


@every_basis
def test_the_largest_values_of_a_curve_bound_all_its_values(basis: Basis) -> None:
    limits = Limits(*np.array([[-1.0, -2.0], [2.0, 0.5], [1.0, 3.0], [2.0, 4.0]]))
    curve = random_curve(basis, np.zeros(2), limits, np.random.default_rng(1))
    q, dq, ddq = curve.sample(np.linspace(0.0, basis.duration, 100_003))
    below, above, fast, hard = curve.largest()
    for bound, values in ((below, -q), (above, q), (fast, np.abs(dq)), (hard, np.abs(ddq))):
        assert np.all(values.max(axis=1) <= bound)
        assert values.max(axis=1) == pytest.approx(bound, rel=1e-4, abs=1e-6)
