"""Quintics through via points: their closed form, and what is refused."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.trajectories.joined import approach
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.via import ViaPath, reach, through
from scarid_cli.errors import UsageFault

sizes = st.floats(1e-3, 1e3)
pairs = st.lists(sizes, min_size=2, max_size=2)
lengths = st.floats(0.1, 5.0)
laws = settings(max_examples=100, deadline=None)


@given(distance=st.floats(0.01, 10.0), T=lengths)
@laws
def test_segment_attains_the_peaks_of_the_closed_form(distance: float, T: float) -> None:
    """15/8 D/T in the middle; 10/sqrt(3) D/T^2 at 1/2 - 1/sqrt(12), and the opposite after it."""
    path = ViaPath(np.array([0.0, T]), np.array([[0.0], [distance]]))
    peaks = T * (0.5 + np.array([-1.0, 0.0, 1.0]) / np.sqrt(12.0))
    _, dq, ddq = path.sample(peaks)
    largest = 10.0 / np.sqrt(3.0) * distance / T**2
    assert dq[0, 1] == pytest.approx(15.0 / 8.0 * distance / T, rel=1e-12)
    np.testing.assert_allclose(ddq[0], [largest, 0.0, -largest], rtol=1e-12, atol=1e-9 * largest)


@given(dq=pairs, ddq=pairs, T=lengths)
@laws
def test_reach_is_as_far_as_velocity_and_acceleration_allow(
    dq: list[float], ddq: list[float], T: float
) -> None:
    box = Limits(-np.ones(2), np.ones(2), np.array(dq), np.array(ddq))
    far = reach(box, T)
    fastest = 15.0 / 8.0 * far / T / box.dq
    hardest = 10.0 / np.sqrt(3.0) * far / T**2 / box.ddq
    np.testing.assert_allclose(np.maximum(fastest, hardest), 1.0, rtol=1e-12)


@pytest.mark.parametrize("start", [0.4, 0.5, -0.4])
@pytest.mark.parametrize("dq", [0.5, 50.0])
def test_an_approach_is_as_fast_as_a_fifth_of_the_limits(start: float, dq: float) -> None:
    """Of velocity or of acceleration, whichever is reached first; a row at least."""
    box = Limits(-np.ones(1), np.ones(1), np.array([dq]), np.array([10.0]))
    path = approach(np.array([start]), np.array([0.4]), box, 1000.0)
    _, v, a = path.sample(np.linspace(0.0, path.duration, 2001))
    reached = max(np.abs(v).max() / box.dq[0], np.abs(a).max() / box.ddq[0])
    assert reached == pytest.approx(0.2 if start != 0.4 else 0.0, rel=0.02)
    assert path.duration >= 1e-3


def test_velocity_and_acceleration_are_the_slopes_of_the_position() -> None:
    path = ViaPath(np.array([0.0, 0.7, 2.0]), np.array([[0.0], [0.4], [-0.3]]))
    t, h = np.linspace(0.05, 0.65, 50), 1e-4
    (before, v_before, _), (_, v, a), (after, v_after, _) = (
        path.sample(t + k * h) for k in (-1, 0, 1)
    )
    # Central differences: h^2 / 6 times the third derivative, of some hundred, is some 1e-7.
    np.testing.assert_allclose((after - before) / (2.0 * h), v, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose((v_after - v_before) / (2.0 * h), a, rtol=0.0, atol=1e-5)


# Via points of one's own

BOX = Limits(*np.array([[-1.0, -2.0], [0.5, 2.0], [2.0, 2.0], [8.0, 8.0]]))
HOME = np.zeros(2)


def via(*points: tuple[float, float], T: float = 2.0) -> ViaPath:
    return ViaPath(T * np.arange(len(points)), np.array(points))


@pytest.mark.parametrize("home", [(0.0, 0.0), (0.4, -1.0), (-1.0, 2.0)])
def test_via_points_within_the_limits_are_taken_as_they_are(home: tuple[float, float]) -> None:
    path = via(home, (-0.5, 1.0), home)
    assert through(path, BOX, np.array(home)) is path


@pytest.mark.parametrize(
    ("path", "complaint"),
    [
        (
            via((0.1, 0.0), (0.1, 0.0)),
            "must start at the home position: joint 1 is at 0.1 and its home at 0; give --home "
            "0.1,0 or change the via points",
        ),
        (
            via((0.0, 0.0), (0.0, 0.1)),
            "must end at the home position: joint 2 is at 0.1 and its home at 0; change the last",
        ),
        (via((0.0, 0.0)), "two via points or more"),
        (via((0.0, 0.0), (0.0, 0.0), T=0.0), "times that increase"),
        (
            via((0.0, 0.0), (0.0, 2.1), (0.0, 0.0)),
            "via point 2: joint 2 at 2.1 is outside its position limits, -2 to 2",
        ),
        (
            via((0.0, 0.0), (0.6, 0.0), (0.0, 0.0)),
            "via point 2: joint 1 at 0.6 is outside its position limits, -1 to 0.5",
        ),
        (
            via((0.0, 0.0), (0.0, 0.2), (-1.0, 0.2), (0.0, 0.0), T=0.5),
            "segment 2: joint 1 would reach velocity 3.75 and acceleration 23.09, "
            "its bounds are 2 and 8; give the segment at least",
        ),
    ],
)
def test_via_points_beyond_the_limits_are_refused(path: ViaPath, complaint: str) -> None:
    with pytest.raises(UsageFault, match=re.escape(complaint)):
        through(path, BOX, HOME)


@given(home=st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=2))
@laws
def test_advice_on_the_home_position_is_good_advice(home: list[float]) -> None:
    """The position it asks for, as printed, is taken."""
    wide = Limits(*np.array([[-2e3, -2e3], [2e3, 2e3], [1e9, 1e9], [1e9, 1e9]]))
    assume(max(map(abs, home)) > 1e-8)
    path = via((home[0], home[1]), (0.0, 0.0), (home[0], home[1]))
    with pytest.raises(UsageFault) as refused:
        through(path, wide, HOME)
    advice = re.search(r"give --home (\S+) or", str(refused.value))
    assert advice is not None
    through(path, wide, np.array([float(x) for x in advice[1].split(",")]))


@given(distance=st.floats(0.01, 10.0), limit=st.tuples(sizes, sizes))
@laws
def test_advice_on_a_fast_segment_is_good_advice(
    distance: float, limit: tuple[float, float]
) -> None:
    """The time it asks for, as printed, is enough."""
    box = Limits(np.array([-100.0]), np.array([100.0]), *(np.array([x]) for x in limit))
    points = np.array([[0.0], [distance], [0.0]])
    with pytest.raises(UsageFault) as refused:
        through(ViaPath(1e-3 * np.arange(3.0), points), box, np.zeros(1))
    advice = re.search(r"give the segment at least (\S+) s", str(refused.value))
    assert advice is not None
    through(ViaPath(float(advice[1]) * np.arange(3.0), points), box, np.zeros(1))
