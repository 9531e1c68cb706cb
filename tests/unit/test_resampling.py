"""A jittered log on a regular clock."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.tables import Kept, collected, table

from scarid_cli.algorithms.processes.resampling import (
    BETA,
    CUTOFF,
    REACH,
    Clock,
    Decimator,
    Resampler,
)
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData
from scarid_cli.stages.resample import resample

PERIOD = 0.002


def jittered(samples: int = 500, seed: int = 0) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    t = 3.0 + np.cumsum(rng.uniform(0.5, 1.5, samples)) * PERIOD
    return t, np.vstack((np.sin(40.0 * t), rng.standard_normal(samples)))


def stepped(resampler: Resampler, t: Array, x: Array) -> tuple[Array, Array]:
    _, at, rows = resampler.step(resampler.init(t[0], x[:, 0]), t[1:], x[:, 1:])
    return at, rows


def test_rows_lie_on_straight_lines_between_the_samples() -> None:
    t, x = jittered()
    at, rows = stepped(Resampler(PERIOD), t, x)
    np.testing.assert_allclose(np.diff(at), PERIOD)
    assert at[0] == t[0]
    assert t[-1] - PERIOD < at[-1] <= t[-1]
    for found, values in zip(rows, x, strict=True):
        np.testing.assert_allclose(found, np.interp(at, t, values), rtol=1e-12)


def test_samples_before_the_next_row_are_not_kept() -> None:
    """But for the one from which the line to the next row begins."""
    t, x = jittered()
    resampler = Resampler(PERIOD)
    state = resampler.init(t[0], x[:, 0])
    for k in range(1, len(t), 7):
        state, at, _ = resampler.step(state, t[k : k + 7], x[:, k : k + 7])
        assert not np.any(state.t[1:] <= at[-1] + PERIOD)
        assert state.t[-1] == t[: k + 7][-1]


@pytest.mark.parametrize("factor", [2, 5])
def test_lower_rates_are_those_of_a_kaiser_low_pass(factor: int) -> None:
    """Designed by scipy, over the record turned around its ends, every so many-th sample."""
    x = np.random.default_rng(0).standard_normal((2, 403))
    decimator = Decimator(factor)
    state, numbers, rows = decimator.step(decimator.init(0, 2), x)
    more, rest = decimator.finish(state)
    half = REACH * factor
    taps = scipy.signal.firwin(2 * half + 1, 2.0 * CUTOFF / factor, window=("kaiser", BETA))
    for found, values in zip(np.hstack([rows, rest]), x, strict=True):
        turned = np.concatenate(
            (
                2.0 * values[0] - values[half:0:-1],
                values,
                2.0 * values[-1] - values[-2 : -half - 2 : -1],
            )
        )
        expected = np.convolve(turned, taps, "valid")[::factor]
        np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    assert [*numbers, *more] == list(range(-(-403 // factor)))


def test_a_low_pass_passes_motions_and_stops_what_would_alias() -> None:
    """60 dB from half the new rate on; a thousandth below a quarter of it."""
    at = np.arange(20_000) * 0.001
    for frequency, low, high in ((20.0, 0.999, 1.001), (50.0, 0.0, 0.0012), (203.0, 0.0, 0.001)):
        wave = np.cos(2.0 * np.pi * frequency * at)
        slow = collected(resample(table({"t": at, "q1": wave}), 100.0))
        q = slow.column("q1").to_numpy()[20:-20]
        amplitude = np.sqrt(2.0) * np.std(q) if low else np.abs(q).max()
        assert low <= amplitude <= high, frequency


def test_a_line_stays_a_line_when_the_rate_is_lowered() -> None:
    """To its very ends, of a jittered log: no delay."""
    t, _ = jittered()
    slow = collected(resample(table({"t": t, "q1": 3.0 * t - 1.0}), 60.0))
    at, q = (np.array(slow.column(name)) for name in ("t", "q1"))
    np.testing.assert_allclose(q, 3.0 * at - 1.0, rtol=1e-9)
    assert at[0] == t[0]
    assert at[-1] > t[-1] - 1.0 / 60.0


@given(sizes=st.lists(st.sampled_from([1, 2, 7, 64]), min_size=1, max_size=4),
       rate=st.sampled_from([500.0, 731.0, 60.0]))  # fmt: skip
@settings(max_examples=20, deadline=None)
def test_the_bits_do_not_depend_on_the_batches(sizes: list[int], rate: float) -> None:
    t, (q, tau) = jittered(200)
    t[50] = t[49]  # a repeated row
    columns = {"t": t, "q1": q, "tau1": tau}
    clocks: list[Clock] = []
    whole = collected(resample(table(columns), rate, 0.1, clocks.append))
    cut = collected(resample(table(columns, sizes), rate, 0.1, clocks.append))
    assert cut.equals(whole)
    assert clocks[0] == clocks[1]
    assert clocks[0].repeated == 1


def test_the_clock_is_reported() -> None:
    t, (q, _) = jittered()
    clocks: list[Clock] = []
    collected(resample(table({"t": t, "q1": q}), 500.0, 0.1, clocks.append))
    steps = np.diff(t)
    (clock,) = clocks
    assert clock.mean == pytest.approx(steps.mean())
    assert clock.jitter == pytest.approx(steps.std(), rel=1e-6)
    assert clock.longest == steps.max()


def test_other_columns_have_the_value_of_the_row_before() -> None:
    source = table({"t": np.array([0.0, 1.0, 2.0]), "q1": np.zeros(3)})
    batch = next(source.batches)
    schema = source.schema.append(pa.field("note", pa.string()))
    noted = pa.RecordBatch.from_arrays([*batch.columns, pa.array(["a", "b", "c"])], schema=schema)
    from dataclasses import replace

    found = collected(resample(replace(source, schema=schema, batches=iter([noted])), 2.0, 5.0))
    assert found.column("note").to_pylist() == ["a", "a", "b", "b", "c"]


@pytest.mark.parametrize("sizes", [(), (1,), (2,)])
def test_a_clock_that_goes_back_is_reported(sizes: tuple[int, ...]) -> None:
    source = table({"t": np.array([0.0, 0.1, 0.05, 0.2]), "q1": np.zeros(4)}, sizes)
    message = r"row 3, column t: found time that goes back by 0\.05 s"
    with pytest.raises(BadData, match=message):
        Kept().batches.extend(resample(source, 10.0, 0.2).batches)


def test_rows_that_are_each_there_twice_are_one_log() -> None:
    t = np.repeat(np.arange(50) * 0.01, 2)
    clocks: list[Clock] = []
    result = collected(resample(table({"t": t, "q1": t}), 100.0, report=clocks.append))
    np.testing.assert_allclose(result.column("q1"), np.arange(50) * 0.01)
    assert clocks[0].repeated == 50


def test_a_clock_that_stands_still_is_reported() -> None:
    with pytest.raises(BadData, match="column t: found a time that never increases"):
        collected(resample(table({"t": np.ones(5), "q1": np.ones(5)}), 100.0))
