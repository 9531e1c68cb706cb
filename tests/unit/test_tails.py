"""Tails of the t and F distributions against scipy."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.stats

from scarid_cli.algorithms.uncertainty.tails import log_tail_f, log_tail_t


@pytest.mark.parametrize(("k", "n"), [(1, 1), (1, 39), (2, 9), (10, 39), (64, 39), (3, 1000)])
@pytest.mark.parametrize("value", [1e-6, 0.1, 0.9, 1.0, 3.0, 40.0, 300.0])
def test_the_tail_of_f(value: float, k: int, n: int) -> None:
    expected = scipy.stats.f.logsf(value, k, n)
    assert log_tail_f(value, k, n) == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_the_tail_of_f_does_not_underflow() -> None:
    assert -2000.0 < log_tail_f(1e12, 4, 100) < -1000.0
    assert log_tail_f(0.0, 4, 100) == 0.0
    assert log_tail_f(np.inf, 4, 100) == -np.inf


@pytest.mark.parametrize("value", [-3.0, 0.5, 7.0])
def test_the_tails_of_t(value: float) -> None:
    expected = np.log(2.0) + scipy.stats.t.logsf(abs(value), 12)
    assert log_tail_t(value, 12) == pytest.approx(expected, rel=1e-9)


def test_the_tail_of_f_at_the_ends_of_the_doubles() -> None:
    """Where the argument of the beta function is 0 or 1 by rounding."""
    assert log_tail_f(1e308, 39.0, 5.0) == -np.inf
    assert log_tail_f(5e-324, 1.0, 1000.0) == 0.0
