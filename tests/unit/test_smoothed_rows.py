"""The rows behind a Hann window, with which the alternatives to the model are compared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.effects.parallel import smoothed
from scarid_cli.algorithms.regression.rows import plain

H = 0.01  # s


def test_smoothed_rows_are_those_at_the_middle_of_the_window() -> None:
    """A window that is symmetric keeps what is linear in time; none reaches across a gap."""
    at = np.concatenate((np.arange(200), np.arange(500, 720)))
    W = np.stack((1.0 * at, 3.0 - 2.0 * at), axis=1)[:, None, :]
    rows = replace(plain(W, 0.5 * at[:, None], H), at=at)
    found = smoothed(rows, None, np.zeros(2), 2)
    assert found is not None
    for column, expected in ((0, at), (1, 3.0 - 2.0 * at), (-1, 0.5 * at)):
        np.testing.assert_allclose(found.A[:, 0, column], expected[found.centres], atol=1e-9)
    np.testing.assert_array_equal(found.at, at[found.centres])
    starts = found.centres[0]
    np.testing.assert_array_equal(
        at[found.centres + starts] - at[found.centres - starts], 2 * starts
    )
    assert np.diff(found.centres).min() == 2  # 20 ms: no more than 25 ms
    assert len(found.centres) == 2 * 86 + 10  # of 200 - 28 and 220 - 28 samples, every second
