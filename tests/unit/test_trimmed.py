"""Least squares from the part of a record that the model explains best."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.regression.rows import Rows, plain
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.trimmed import trimmed
from scarid_cli.arrays import Array

H, TRUTH = 0.01, np.array([2.0, -0.5, 1.0])


def record(seed: int, push: float = 0.0) -> Rows:
    """20 s of two joints, of which the second is noisier; a push at the first from 5 to 8 s."""
    rng = np.random.default_rng(seed)
    t = H * np.arange(2000)
    W = rng.standard_normal((2000, 2, 3)) + np.sin(np.outer(t, [0.3, 0.7, 1.1]))[:, None]
    y = W @ TRUTH + rng.standard_normal((2000, 2)) * (0.01, 0.1)
    y[(t >= 5.0) & (t < 8.0), 0] += push
    return plain(W, y, H)


def estimates(rows: Rows) -> Array:
    return trimmed(Blocks.every(rows.h).add(rows).whole())


@pytest.mark.parametrize("push", [1.0, 100.0])
def test_a_push_does_not_move_the_estimates(push: float) -> None:
    """Those of least squares are off by up to half of it."""
    for seed in range(5):
        found = estimates(record(seed, push))
        np.testing.assert_allclose(found, TRUTH, atol=0.003)
        np.testing.assert_allclose(found, estimates(record(seed)), atol=0.003)


def test_a_joint_without_rows_does_not_count() -> None:
    rows = record(1)
    rows.scales[:, 1] = 0.0
    rows.y[:, 1] = 1e6
    np.testing.assert_allclose(estimates(rows), TRUTH, atol=0.003)


def test_what_the_record_does_not_determine_is_zero() -> None:
    rows = record(1)
    rows.W[:, :, 2] = 0.0
    assert estimates(rows)[2] == 0.0
