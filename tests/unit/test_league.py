"""The figure of the first screen: labels that do not overlap, and what many values become."""

from __future__ import annotations

import itertools
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.reporting.study.league import (
    APART,
    League,
    Place,
    decades,
    drawn,
    joint_percents,
)

VALUE = st.floats(1e-6, 1e9)


@given(st.lists(st.lists(VALUE, min_size=1, max_size=7), min_size=1, max_size=12))
def test_labels_of_decades_stand_apart_and_marks_within(rows: list[list[float]]) -> None:
    places = tuple(Place("a", "m0", "", tuple(values)) for values in rows)
    text = str(drawn(League("", "", ("x",) * 7, places)))
    labels = [float(x) for x in re.findall(r'x="([\d.]+)" y="[\d.]+" class="x">[\de.+-]+ %', text)]
    assert all(b - a >= APART - 1.0 for a, b in itertools.pairwise(labels))
    ends = [float(x) for x in re.findall(r'd="M([\d.]+) [\d.]+V', text)]
    marks = [float(x) for x in re.findall(r'cx="([\d.]+)"', text)]
    assert all(min(ends) - 0.1 <= x <= max(ends) + 0.1 for x in marks)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((12.3,), "12 %"),
        ((0.5, 120.0), "over 100 %"),
        ((1.0, 2.0, 3.0), "1, 2, 3 %"),
        ((1.0, 5.0, 3.0, 0.2), "0.2 to 5 %"),
    ],
)
def test_values_in_words(values: tuple[float, ...], text: str) -> None:
    league = League("", "", ("x",), (Place("a", "m0", "", values),), most=100.0)
    assert league.text(values) == text
    assert decades(league)[1] <= 2


def test_values_of_joints_have_their_joints() -> None:
    assert joint_percents([1.42, 6.2]) == "joint 1 1.4 %, joint 2 6.2 %"
    assert joint_percents([1.42]) == "1.4 %"
