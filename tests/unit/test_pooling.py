"""Identifications that are pooled give what all logs give together."""

from __future__ import annotations

import numpy as np
import pytest

from scarid_cli.algorithms.changes.evidence import LogEvidence
from scarid_cli.algorithms.changes.pooling import pooled
from scarid_cli.arrays import Array

JOINTS, PARAMETERS = 2, 3
COLUMNS = PARAMETERS + 1 + 2 * JOINTS
DEVIATIONS = (np.array([1.0, 2.0]), np.array([3.0, 2.0]))


def logs(at: list[Array], rng: np.random.Generator) -> tuple[Array, Array, list[LogEvidence]]:
    """Rows and right sides of all logs, and the evidence of each one at its point."""
    W = [rng.normal(size=(rows, COLUMNS)) for rows in (40, 90)]
    y = [own @ np.arange(COLUMNS) + rng.normal(size=len(own)) for own in W]
    found = [
        LogEvidence(A.T @ A, A.T @ (b - A @ x), deviations, np.zeros((7, COLUMNS)))
        for A, b, x, deviations in zip(W, y, at, DEVIATIONS, strict=True)
    ]
    return np.vstack(W), np.concatenate(y), found


@pytest.mark.parametrize("delays", [(0.3, -0.2), (0.3, 0.0), (0.0, 0.0)])
def test_pooled_estimates_are_those_of_all_rows(delays: tuple[float, float]) -> None:
    rng = np.random.default_rng(5)
    thetas = [rng.normal(size=PARAMETERS) for _ in delays]
    at = [np.array([*theta, delay, *np.zeros(2 * JOINTS)])
          for theta, delay in zip(thetas, delays, strict=True)]  # fmt: skip
    W, y, found = logs(at, rng)
    free = PARAMETERS + any(delays)
    together = np.linalg.lstsq(W[:, :free], y, rcond=None)[0]
    result = pooled(thetas, delays, found)
    assert np.append(result.theta, result.delay)[:free] == pytest.approx(together)
    assert any(delays) or result.delay == 0.0
    assert result.evidence.score == pytest.approx(W.T @ (y - W[:, :free] @ together))
    assert result.evidence.information == pytest.approx(W.T @ W)
    assert result.evidence.deviations == pytest.approx(np.sqrt([5.0, 4.0]))
    assert result.evidence.blocks == 14


def test_what_no_log_determines_keeps_the_value_of_the_first_log() -> None:
    rng = np.random.default_rng(6)
    thetas = [np.array([1.0, 2.0, 3.0]), np.array([5.0, 6.0, 7.0])]
    _, _, found = logs([np.zeros(COLUMNS)] * 2, rng)
    for own in found:
        own.information[1] = own.information[:, 1] = own.score[1] = 0.0
    assert pooled(thetas, (0.0, 0.0), found).theta[1] == 2.0
