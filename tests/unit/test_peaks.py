"""How often residuals pass the level that is stated for a rate."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.uncertainty.peaks import BLOCK, HOUR, Peaks, peaks_of
from scarid_cli.arrays import Array

H = 0.01
RATE = 72.0  # 1/h: one block of a hundred


def noise(kind: str, count: int, rng: np.random.Generator) -> Array:
    """Residuals whose largest values fall like a normal or an exponential distribution."""
    if kind == "Laplace":
        return rng.laplace(size=count)
    white = rng.standard_normal(count + 9)
    return np.convolve(white, np.ones(10) / 10**0.5, "valid") if kind == "coloured" else white[9:]


@pytest.mark.parametrize("kind", ["white", "coloured", "Laplace"])
def test_the_level_is_passed_as_often_as_stated(kind: str) -> None:
    """Of logs of 20 s, on average, in blocks of other noise of the same kind."""
    rng = np.random.default_rng(3)
    per_block = round(BLOCK / H)
    others = np.abs(noise(kind, 40_000 * per_block, rng)).reshape(-1, per_block).max(axis=1)
    rates = []
    for _ in range(200):
        log = noise(kind, 40 * per_block, rng)
        level = peaks_of(log, np.arange(len(log)), H).level(RATE, 40)
        rates.append(HOUR / BLOCK * np.mean(others > level))
    assert 0.3 * RATE < np.mean(rates) < 1.3 * RATE


def test_the_level_of_a_known_distribution_is_its_quantile() -> None:
    """Gumbel's: P(x < level) = exp(-exp(-(level - mode) / scale))."""
    peaks = Peaks(2.0, 0.5)
    level = peaks.level(RATE, np.inf)
    assert np.exp(-np.exp(-(level - 2.0) / 0.5)) == pytest.approx(1.0 - RATE * BLOCK / HOUR)


def test_the_moments_are_those_of_gumbels_distribution() -> None:
    rng = np.random.default_rng(0)
    largest = rng.gumbel(3.0, 0.7, 20_000)
    found = peaks_of(largest, np.arange(len(largest)), BLOCK)
    assert found.mode == pytest.approx(3.0, abs=0.03)
    assert found.scale == pytest.approx(0.7, abs=0.02)


def test_few_blocks_say_nothing() -> None:
    assert np.isnan(peaks_of(np.ones(400), np.arange(400), H).mode)
    assert np.isnan(peaks_of(np.empty(0), np.arange(0), H).scale)
