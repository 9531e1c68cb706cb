"""What a fit absorbs of slow noise: against products of whole matrices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.algorithms.uncertainty.absorption import INTERVAL, LAGS, absorbed

SAMPLES, PARAMETERS = 80, 5


@pytest.mark.parametrize("time", [0.1, 0.8, 4.0])
def test_what_is_absorbed_is_that_of_whole_matrices(time: float) -> None:
    """Two joints of different weights, some of whose rows are left out."""
    rng = np.random.default_rng(1)
    W = np.cumsum(rng.standard_normal((SAMPLES, 2, PARAMETERS)), axis=0)
    weights, scales = np.array([0.5, 3.0]), np.ones((SAMPLES, 2))
    scales[[3, 4, 30], [0, 0, 1]] = 0.0
    rows = replace(plain(W, np.zeros((SAMPLES, 2)), INTERVAL), scales=scales)
    scaled = (W * (scales * weights)[:, :, None]).transpose(1, 0, 2).reshape(-1, PARAMETERS)
    inverse = np.linalg.inv(scaled.T @ scaled)
    found = absorbed(rows, weights, inverse, [time])[:, 0]

    noise = np.exp(-np.abs(np.subtract.outer(*2 * [np.arange(SAMPLES)])) * INTERVAL / time)
    noise = np.kron(np.eye(2), noise)
    counts = scales.T.ravel() > 0.0
    keep = np.eye(len(counts)) - scaled @ inverse @ scaled.T
    taken = noise - keep @ noise @ keep.T
    for joint in range(2):
        own = slice(joint * SAMPLES, (joint + 1) * SAMPLES)
        pairs = np.outer(counts[own], counts[own])
        for k, lag in enumerate(np.round(LAGS / INTERVAL).astype(int).tolist()):
            both = np.diagonal(pairs, lag)
            expected = np.diagonal(taken[own, own], lag)[both].mean()
            symmetric = np.diagonal(taken[own, own].T, lag)[both].mean()
            assert found[joint, k] == pytest.approx(0.5 * (expected + symmetric), abs=1e-10)
