"""Logs with gaps: what resample marks, every stage after it respects."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from conftest import long
from hypothesis import given, settings
from hypothesis import strategies as st
from stages.tables import PERIOD, SCARA, Kept, collected, cut, motion, table
from unit.support import GIVEN, without_search

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.filters.butterworth import Butterworth, ZeroPhase
from scarid_cli.algorithms.processes.resampling import Clock
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, TooShort
from scarid_cli.io.reader import checked
from scarid_cli.io.table import Table, segments, without
from scarid_cli.stages.differentiate import differentiate, matched
from scarid_cli.stages.filter import filtered
from scarid_cli.stages.identify import identify
from scarid_cli.stages.resample import resample
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.validate import validate

Stage = Callable[[Table], Table]
LENGTHS = (150, 3, 120, 127)  # rows of the segments; the second is too short for some methods
SIZES = st.lists(st.sampled_from([1, 2, 7, 64, 8192]), min_size=1, max_size=4)


def gapped(sizes: list[int] | None = None, lengths: tuple[int, ...] = LENGTHS) -> Table:
    """A motion in segments, time jumping by a tenth of a second between them."""
    columns = motion()
    segment = np.repeat(np.arange(len(lengths)), lengths)
    rows = len(segment)
    columns = {name: x[:rows] for name, x in columns.items()}
    columns["t"] = columns["t"] + 0.1 * segment
    plain = table(columns)
    batch = next(plain.batches)
    schema = plain.schema.append(pa.field("segment", pa.int64()))
    whole = pa.RecordBatch.from_arrays([*batch.columns, pa.array(segment)], schema=schema)
    return replace(plain, schema=schema, batches=cut(whole, sizes or ()))


STAGES: dict[str, Stage] = {
    "filter": lambda source: filtered(source, {"q1": Butterworth(20.0)}),
    "filter zero-phase": lambda source: filtered(source, {"q1": ZeroPhase(20.0)}),
    **{
        f"differentiate {name}{' --match' if stage is matched else ''}": (
            lambda source, name=name, stage=stage: stage(source, [without_search(name)] * 2)
        )
        for name in DIFFERENTIATORS.names
        for stage in (differentiate, matched)
    },
}


@pytest.mark.parametrize("name", STAGES)
def test_each_segment_is_a_record_of_its_own(name: str) -> None:
    """Bit for bit; those that the stage refuses alone are left out."""
    assert of_its_own(STAGES[name], LENGTHS) >= 3


@long
@pytest.mark.parametrize("name", GIVEN)
def test_settings_are_found_in_each_segment(name: str) -> None:
    methods = [DIFFERENTIATORS.load(name)()] * 2
    assert of_its_own(lambda source: differentiate(source, methods), (60, 50)) == 2


def of_its_own(stage: Stage, lengths: tuple[int, ...]) -> int:
    """How many segments are not refused, each of which gives together what it gives alone."""
    alone = []
    for segment in segments(gapped(lengths=lengths)):
        batches = list(segment.batches)
        try:
            alone.append(collected(stage(replace(segment, batches=iter(batches)))))
        except TooShort:
            assert sum(batch.num_rows for batch in batches) < 100
    together = collected(stage(gapped([64, 7], lengths)))
    assert together.equals(pa.concat_tables(alone).combine_chunks())
    return len(alone)


@pytest.mark.parametrize("stage", [differentiate, matched])
def test_the_ends_of_segments_are_marked(stage: Callable[..., Table]) -> None:
    """As the ends of a record are: rows whose response to a step is not over."""
    result = collected(stage(gapped(), [DIFFERENTIATORS.load("kalman-lag")()] * 2))
    marks = np.array(result.column("settled"))
    numbers = np.array(result.column("segment"))
    whole = collected(
        matched(without(gapped(), "segment"), [DIFFERENTIATORS.load("kalman-lag")()] * 2)
    )
    start = int(np.argmax(np.array(whole.column("settled"))))
    end = int(np.argmax(np.array(whole.column("settled"))[::-1]))
    assert start > 5
    for number in np.unique(numbers):
        rows = int((numbers == number).sum())
        expected = (np.arange(rows) >= start) & (np.arange(rows) < rows - end)
        np.testing.assert_array_equal(marks[numbers == number], expected)


def test_a_log_of_nothing_but_short_segments_is_refused() -> None:
    source = next(part for part in segments(gapped()) if part.name.endswith("segment 0"))
    short = replace(source, batches=(batch.slice(0, 20) for batch in source.batches))
    left_out: list[TooShort] = []
    with pytest.raises(TooShort, match=r"segment 0: .* shorten"):
        list(matched(short, [DIFFERENTIATORS.load("kalman-lag")()] * 2, left_out).batches)


@pytest.mark.parametrize("name", ["rls", "wls", "ml"])
@pytest.mark.parametrize("treatment", [Treatment(), Treatment(decimate=(2,))], ids=["", "decimate"])
def test_estimates_of_a_gapped_log_are_those_of_its_rows(name: str, treatment: Treatment) -> None:
    """No row is lost or joined across a gap: residual-free rows give the parameters exactly."""
    q, dq, ddq = (np.vstack([motion()[f"{s}{i}"] for i in (1, 2)]) for s in ("q", "dq", "ddq"))
    exact = SCARA.torques(SCARA.regressor(q, dq, ddq), SCARA.apriori)
    batch = next(gapped().batches)
    rows = batch.num_rows
    for i in (1, 2):
        at = batch.schema.get_field_index(f"tau{i}")
        batch = batch.set_column(at, batch.schema.field(at), pa.array(exact[i - 1][:rows]))
    source = replace(gapped(), batches=iter([batch]))
    result = collected(
        identify(source, SCARA, ESTIMATORS.load(name)(), SCARA.apriori, treatment=treatment)
    )
    np.testing.assert_allclose(result.column("estimate"), SCARA.apriori, rtol=1e-6, atol=1e-6)


def test_predictions_and_traces_keep_their_segment() -> None:
    predictions, trace = Kept(), Kept()
    collected(validate(gapped(), Identified(SCARA, SCARA.apriori, 1e-3), predictions=predictions))
    identify(gapped(), SCARA, ESTIMATORS.load("rls")(), SCARA.apriori, trace=trace)
    expected = np.repeat(np.arange(len(LENGTHS)), LENGTHS)
    for kept in (predictions, trace):
        np.testing.assert_array_equal(kept.table.column("segment"), expected)


def measured(t: Array, sizes: tuple[int, ...] = ()) -> Table:
    return table({"t": t, "q1": np.sin(t)}, sizes)


@given(sizes=SIZES)
@settings(max_examples=20, deadline=None)
def test_resample_splits_at_gaps_and_lays_nothing_across(sizes: list[int]) -> None:
    rng = np.random.default_rng(0)
    t = np.cumsum(rng.uniform(0.8, 1.2, 300)) * PERIOD
    t[100:] += 0.4
    t[101:] += 0.3  # a segment of one sample
    t[200:] += 0.2
    clocks: list[Clock] = []
    result = collected(resample(measured(t, tuple(sizes)), 1.0 / PERIOD, report=clocks.append))
    at, q, segment = (np.array(result.column(name)) for name in ("t", "q1", "segment"))
    np.testing.assert_allclose((at - at[0]) / PERIOD, np.round((at - at[0]) / PERIOD), atol=1e-6)
    np.testing.assert_allclose(q, np.interp(at, t, np.sin(t)), rtol=1e-12)
    ends = [(t[0], t[99]), (t[100], t[100]), (t[101], t[199]), (t[200], t[-1])]
    for number, (start, end) in enumerate(ends):
        own = at[segment == number]
        assert np.all((start <= own) & (own <= end + 1e-12))
        assert len(own) == np.floor((end - at[0]) / PERIOD) - np.ceil((start - at[0]) / PERIOD) + 1
    (clock,) = clocks
    assert clock.gaps == 3
    assert clock.missing == pytest.approx(np.diff(t)[[99, 100, 199]].sum())
    assert clock.longest < 1.3 * PERIOD


def test_a_segmented_log_is_regular_between_its_gaps_only() -> None:
    t = np.arange(100) * PERIOD
    t[50:] += 0.0123
    segments_of_rows = np.repeat([0, 1], 50)

    def read(marks: Array) -> pa.Table:
        source = measured(t)
        schema = source.schema.append(pa.field("segment", pa.int64()))
        batch = next(source.batches)
        both = pa.RecordBatch.from_arrays([*batch.columns, pa.array(marks)], schema=schema)
        return collected(
            checked(replace(source, schema=schema, batches=iter([both])), "measurement")
        )

    assert read(segments_of_rows).num_rows == 100
    with pytest.raises(BadData, match=r"row 51, column t: found an interval of 0\.0173 s"):
        read(np.zeros(100, dtype=np.int64))
    with pytest.raises(BadData, match="row 51, column segment: found a smaller number"):
        read(1 - segments_of_rows)


def test_resampling_again_keeps_the_gaps() -> None:
    """Even those that are short for the new rate."""
    t = np.arange(400) * PERIOD
    t[200:] += 8 * PERIOD
    once = resample(measured(t), 1.0 / PERIOD)
    twice = collected(resample(once, 0.1 / PERIOD))
    assert set(twice.column("segment").to_pylist()) == {0, 1}


@given(sizes=SIZES)
@settings(max_examples=5, deadline=None)
def test_estimates_have_the_same_bits_however_the_rows_of_segments_arrive(sizes: list[int]) -> None:
    def identified(cuts: list[int] | None) -> pa.Table:
        rls = ESTIMATORS.load("rls")()
        return collected(identify(gapped(cuts), SCARA, rls, SCARA.apriori))

    assert identified(sizes).equals(identified(None))
