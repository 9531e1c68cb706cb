"""The laws that every differentiator keeps."""

from __future__ import annotations

from dataclasses import fields
from functools import cache, partial
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from unit.support import (
    GIVEN,
    PERIOD,
    cuts,
    derivatives,
    encoder_readings,
    every_differentiator,
    without_search,
)

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.errors import ScaridError, UsageFault

ROWS = 120

METHODS = dict(every_differentiator())
every_method = pytest.mark.parametrize("make", METHODS.values(), ids=METHODS)
# Without searches for settings, for properties of many examples
QUICK = METHODS | {name: partial(without_search, name) for name in GIVEN}


@pytest.mark.parametrize("make", QUICK.values(), ids=QUICK)
@given(chunks=cuts(ROWS))
@settings(max_examples=30, deadline=None)
def test_chunks_do_not_change_a_bit(make: Any, chunks: list[slice]) -> None:
    cut = derivatives(make(), encoder_readings(ROWS), chunks)
    np.testing.assert_array_equal(cut, at_once(make))


@cache
def at_once(make: Any) -> Any:
    return derivatives(make(), encoder_readings(ROWS))


@every_method
def test_step_leaves_its_state_alone(make: Any) -> None:
    method, q = make(), encoder_readings(2 * ROWS)
    state, _ = method.step(method.init(q[0], PERIOD), q[:ROWS])
    first, second = (method.step(state, q[ROWS:])[1] for _ in range(2))
    np.testing.assert_array_equal(first, second)


@every_method
@pytest.mark.parametrize("rows", [2, 3, ROWS])
def test_every_position_gets_its_derivatives(make: Any, rows: int) -> None:
    method = make()
    try:
        v, a = derivatives(method, encoder_readings(rows))
    except ScaridError:
        assert method.lag(PERIOD) > 2, "only a method that looks far ahead needs a longer record"
        assert rows < ROWS
    else:
        assert len(v) == len(a) == rows


@every_method
def test_output_lags_by_what_the_method_declares(make: Any) -> None:
    method, q = make(), encoder_readings(ROWS)
    _, settled = method.step(method.init(q[0], PERIOD), q)
    lengths = {len(x) for x in settled} or {0}
    assert lengths == {max(ROWS - method.lag(PERIOD), 0)}


@every_method
@given(position=st.floats(-1e3, 1e3))
@settings(max_examples=20, deadline=None)
def test_standing_still_starts_without_a_jump(make: Any, position: float) -> None:
    # What differences of a position may be that a filter rounds in each of some dozen steps
    v, a = derivatives(make(), np.full(ROWS, position))
    bit = np.spacing(max(abs(position), 1.0))
    np.testing.assert_allclose(v, 0.0, atol=50.0 * bit / PERIOD)
    np.testing.assert_allclose(a, 0.0, atol=50.0 * bit / PERIOD**2)


@pytest.mark.parametrize(
    ("name", "setting", "value"),
    [
        (name, field.name, value)
        for name in DIFFERENTIATORS.names
        for field in fields(DIFFERENTIATORS.load(name))
        for value in (-1.0, nan)
    ]
    + [
        ("ed-fir", "order", 0.0),
        ("ed-fir", "order", 2.5),
        ("ed-fir", "order", inf),
        ("ed-fir", "cutoff", 0.0),
        ("p2smd", "gamma0", 0.0),
        ("p2smd", "gamma0", inf),
        ("p2smd", "leak", inf),
        ("p2smd", "cap", 0.0),
        ("2smd", "eta2", 0.0),
        ("2smd", "eta0", inf),
        ("astd", "gamma", 0.0),
        ("savgol", "window", 5.0),  # its degree
        ("savgol-end", "window", 3.0),
    ],
)
def test_setting_without_sense_is_refused(name: str, setting: str, value: float) -> None:
    with pytest.raises(UsageFault, match=rf"^{setting} must"):
        DIFFERENTIATORS.load(name)(**{setting: value})
