"""The Kalman smoother part by part, against the smoother of the whole record at once."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.algorithms.differentiators.rts import Differentiator
from scarid_cli.algorithms.filters import kalman, smoothing
from scarid_cli.algorithms.filters.smoothing import MatchedSmoothing, rows_ahead
from scarid_cli.algorithms.processes.matching import over

H = 0.002


def positions(rows: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    t = H * np.arange(rows)
    turns = sum(rng.normal() * np.sin(rng.uniform(0.5, 20.0) * t + k) for k in range(4))
    return np.asarray(turns + 1e-5 * rng.standard_normal(rows))


def at_once(method: Differentiator, x: np.ndarray) -> np.ndarray:
    state, records = kalman.recorded(method.model(H).at_rest(float(x[0])), x)
    return kalman.smoothed(records, state).T


@given(
    states=st.integers(3, 5),
    intensity=st.floats(0.0, 8.0),
    seed=st.integers(0, 1000),
)
def test_parts_are_the_whole_but_for_rounding(states: int, intensity: float, seed: int) -> None:
    method = Differentiator(noise=1e-5, intensity=10.0**intensity, states=states)
    part = max(smoothing.ROWS, smoothing.TIMES * rows_ahead(method, H))
    x = positions(part + rows_ahead(method, H) + 500, seed)
    parts, whole = np.array(over(MatchedSmoothing(method), x, H)), at_once(method, x)
    assert parts.shape == whole.shape
    off = np.abs(parts - whole) / np.abs(whole).max(axis=1)[:, None]
    assert off[:, 1000:].max() < 1e-12
    assert off.max() < 1e-6  # the filter starts from wide variances, and loses digits there


@given(cuts=st.lists(st.integers(1, 39_999), max_size=5))
def test_the_bits_do_not_depend_on_the_batches(cuts: list[int]) -> None:
    form = MatchedSmoothing(Differentiator(noise=1e-5, intensity=500.0))
    x = positions(40_000, 3)
    state = form.init(float(x[0]), H)
    found = []
    for piece in np.split(x, sorted(set(cuts))):
        state, rows = form.step(state, piece)
        found += [rows] if rows else []
    found.append(form.finish(state))
    together = np.array([np.concatenate(pieces) for pieces in zip(*found, strict=True)])
    assert together.tobytes() == np.array(over(form, x, H)).tobytes()


def test_most_rows_are_known_before_the_end() -> None:
    form = MatchedSmoothing(Differentiator(noise=1e-5, intensity=500.0))
    x = positions(100_000, 0)
    _, rows = form.step(form.init(float(x[0]), H), x)
    assert len(rows[0]) > 60_000


def test_a_glitch_at_the_end_does_not_reach_back() -> None:
    """The gain is not constant behind a glitch; the rows before had the constant one."""
    method = Differentiator(noise=1e-5, intensity=200.0)
    x = positions(3000, 1)
    spoiled = x.copy()
    spoiled[-5] += 0.05
    clean, found = (np.array(over(method, y, H)) for y in (x, spoiled))
    assert np.abs(clean - found)[:, :2000].max() < 1e-9
