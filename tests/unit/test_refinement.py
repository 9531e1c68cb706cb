"""Finer samples of a reference: exact, and the same bits whatever the chunks."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.trajectories import hermite


@given(
    coefficients=st.lists(st.floats(-2.0, 2.0), min_size=6, max_size=6),
    period=st.floats(0.01, 2.0),
    ratio=st.integers(1, 12),
)
@settings(max_examples=100, deadline=None)
def test_refine_is_exact_for_a_quintic(
    coefficients: list[float], period: float, ratio: int
) -> None:
    polynomial = np.polynomial.Polynomial(coefficients)
    motion = [polynomial, polynomial.deriv(1), polynomial.deriv(2)]
    coarse, fine = (period * np.arange(4.0), period / ratio * np.arange(3.0 * ratio))
    refined = hermite.refine(*(x(coarse)[None] for x in motion), period, ratio)
    for power, (got, x) in enumerate(zip(refined, motion, strict=True)):
        # Rounding is that of the positions, and each derivative divides it by the period.
        scale = np.abs(motion[0](fine)).max() + 1.0
        atol = 1e-12 * scale / period**power
        np.testing.assert_allclose(got, x(fine)[None], rtol=1e-12, atol=atol)


def test_refine_keeps_the_joints_apart() -> None:
    both = np.random.default_rng(0).standard_normal((3, 2, 5))
    together = hermite.refine(*both, 0.1, 4)
    apart = [hermite.refine(*(x[joint : joint + 1] for x in both), 0.1, 4) for joint in range(2)]
    np.testing.assert_array_equal(together, np.concatenate(apart, axis=1))


def test_refine_rounds_alike_however_many_rows_there_are() -> None:
    """What makes a simulation independent of the chunks its reference comes in."""
    motion = np.random.default_rng(0).standard_normal((3, 2, 9))
    whole = hermite.refine(*motion, 0.1, 4)
    halves = [hermite.refine(*motion[:, :, rows], 0.1, 4) for rows in (np.s_[:5], np.s_[4:])]
    np.testing.assert_array_equal(np.concatenate(halves, axis=2), whole)
