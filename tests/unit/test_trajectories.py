"""Excitation: within its bounds whatever is asked, and exact between its samples."""

from __future__ import annotations

import re
from math import ceil, floor

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.trajectories import hermite
from scarid_cli.algorithms.trajectories.quintic import Bounds, Path, random_path, through
from scarid_cli.errors import UsageFault

# Bounds hold by construction, but for the rounding of a few multiplications.
ROUNDING = 1.0 + 1e-12

limits = st.floats(1e-3, 1e3)
lengths = st.floats(0.1, 5.0)
seeds = st.integers(0, 2**32 - 1)
laws = settings(max_examples=100, deadline=None)


@st.composite
def bounds(draw: st.DrawFn, joints: int | None = None) -> Bounds:
    """Bounds of one to three joints, position bounds perhaps infinite."""
    count = joints or draw(st.integers(1, 3))
    rows = [draw(st.lists(limits, min_size=count, max_size=count)) for _ in range(3)]
    q, dq, ddq = (np.array(row) for row in rows)
    return Bounds(q, dq, ddq)


@st.composite
def requests(draw: st.DrawFn) -> tuple[float, tuple[float, float], bool]:
    """A duration, the range of its segments, and whether the joints take turns (3 at most)."""
    shortest = draw(lengths)
    longest = shortest + draw(st.floats(0.0, 3.0))
    sequential = draw(st.booleans())
    least = 6.0 * shortest if sequential else 2.0 * shortest
    return draw(st.floats(least, least + 60.0)), (shortest, longest), sequential


def at_points(path: Path) -> tuple[np.ndarray, ...]:
    return path.sample(path.times)


@given(bounds=bounds(), request=requests(), seed=seeds)
@laws
def test_random_path_keeps_its_bounds(
    bounds: Bounds, request: tuple[float, tuple[float, float], bool], seed: int
) -> None:
    duration, segment, sequential = request
    rng = np.random.default_rng(seed)
    path = random_path(bounds, duration, segment, rng, sequential=sequential)
    # Twenty times a segment, its middle (peak velocity) and both peaks of the acceleration.
    inner = np.concatenate((np.linspace(0.0, 1.0, 21), 0.5 + np.array([-1, 1]) * np.sqrt(1 / 12)))
    t = (path.times[:-1, None] + np.diff(path.times)[:, None] * inner).ravel()
    for signal, limit in zip(path.sample(t), (bounds.q, bounds.dq, bounds.ddq), strict=True):
        assert np.all(np.abs(signal).max(axis=1) <= limit * ROUNDING)


@given(bounds=bounds(), request=requests(), seed=seeds)
@laws
def test_random_path_begins_and_ends_at_rest_at_zero(
    bounds: Bounds, request: tuple[float, tuple[float, float], bool], seed: int
) -> None:
    duration, segment, sequential = request
    rng = np.random.default_rng(seed)
    path = random_path(bounds, duration, segment, rng, sequential=sequential)
    assert path.times[0] == 0.0
    assert path.duration == duration
    ends = np.array([0.0, duration])
    np.testing.assert_array_equal(path.sample(ends), 0.0)
    # Every via point in between is one at rest, too.
    np.testing.assert_array_equal(at_points(path)[1:], 0.0)
    np.testing.assert_array_equal(at_points(path)[0], path.points.T)


@given(request=requests(), seed=seeds)
@example(request=(2.9, (1.0, 1.05), False), seed=0)
@laws
def test_segments_last_as_long_as_requested(
    request: tuple[float, tuple[float, float], bool], seed: int
) -> None:
    """Whenever a whole number of them makes the duration: at least there and back, per joint."""
    duration, (shortest, longest), sequential = request
    least = 6 if sequential else 2
    assume(max(least, ceil(duration / longest)) <= floor(duration / shortest))
    joints = 3 if sequential else 1
    box = Bounds(*np.ones((3, joints)))
    rng = np.random.default_rng(seed)
    path = random_path(box, duration, (shortest, longest), rng, sequential=sequential)
    T = np.diff(path.times)
    assert shortest * (1.0 - 1e-9) <= T.min()
    assert T.max() <= longest * (1.0 + 1e-9)


@given(bounds=bounds(joints=3), seed=seeds)
@laws
def test_sequential_joints_move_one_at_a_time(bounds: Bounds, seed: int) -> None:
    path = random_path(bounds, 20.0, (0.5, 2.0), np.random.default_rng(seed), sequential=True)
    moving = np.diff(path.points, axis=0) != 0.0
    assert np.all(moving.sum(axis=1) <= 1)
    assert np.all(moving.any(axis=0))


def test_same_seed_gives_the_same_path() -> None:
    box = Bounds(*np.ones((3, 2)))
    first, same, other = (
        random_path(box, 20.0, (0.5, 2.0), np.random.default_rng(seed)).points.tolist()
        for seed in (1, 1, 2)
    )
    assert first == same != other


@pytest.mark.parametrize(
    ("duration", "segment", "complaint"),
    [
        (10.0, (0.0, 1.0), "give 0 < shortest <= longest"),
        (10.0, (2.0, 1.0), "give 0 < shortest <= longest"),
        (1.9, (1.0, 2.0), "too short for 2 segments"),
    ],
)
def test_impossible_random_path_is_refused(
    duration: float, segment: tuple[float, float], complaint: str
) -> None:
    with pytest.raises(UsageFault, match=complaint):
        random_path(Bounds(*np.ones((3, 1))), duration, segment, np.random.default_rng(0))


@given(distance=st.floats(0.01, 10.0), T=lengths)
@laws
def test_segment_attains_the_peaks_of_the_closed_form(distance: float, T: float) -> None:
    """15/8 D/T in the middle; 10/sqrt(3) D/T^2 at 1/2 - 1/sqrt(12), and the opposite after it."""
    path = Path(np.array([0.0, T]), np.array([[0.0], [distance]]))
    peaks = T * (0.5 + np.array([-1.0, 0.0, 1.0]) / np.sqrt(12.0))
    _, dq, ddq = path.sample(peaks)
    largest = 10.0 / np.sqrt(3.0) * distance / T**2
    assert dq[0, 1] == pytest.approx(15.0 / 8.0 * distance / T, rel=1e-12)
    np.testing.assert_allclose(ddq[0], [largest, 0.0, -largest], rtol=1e-12, atol=1e-9 * largest)


@given(bounds=bounds(joints=2), T=lengths)
@laws
def test_reach_is_as_far_as_velocity_and_acceleration_allow(bounds: Bounds, T: float) -> None:
    reach = bounds.reach(T)
    fastest = 15.0 / 8.0 * reach / T / bounds.dq
    hardest = 10.0 / np.sqrt(3.0) * reach / T**2 / bounds.ddq
    np.testing.assert_allclose(np.maximum(fastest, hardest), 1.0, rtol=1e-12)


def test_velocity_and_acceleration_are_the_slopes_of_the_position() -> None:
    path = Path(np.array([0.0, 0.7, 2.0]), np.array([[0.0], [0.4], [-0.3]]))
    t, h = np.linspace(0.05, 0.65, 50), 1e-4
    (before, v_before, _), (_, v, a), (after, v_after, _) = (
        path.sample(t + k * h) for k in (-1, 0, 1)
    )
    # Central differences: h^2 / 6 times the third derivative, of some hundred, is some 1e-7.
    np.testing.assert_allclose((after - before) / (2.0 * h), v, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose((v_after - v_before) / (2.0 * h), a, rtol=0.0, atol=1e-5)


# Via points of one's own

BOX = Bounds(q=np.array([1.0, 2.0]), dq=np.array([2.0, 2.0]), ddq=np.array([8.0, 8.0]))


def via(*points: tuple[float, float], T: float = 2.0) -> Path:
    return Path(T * np.arange(len(points)), np.array(points))


def test_via_points_within_the_bounds_are_taken_as_they_are() -> None:
    path = via((0.0, 0.0), (1.0, -2.0), (0.0, 0.0))
    assert through(path, BOX) is path


@pytest.mark.parametrize(
    ("path", "complaint"),
    [
        (via((0.1, 0.0), (0.0, 0.0)), "must begin at zero in every joint"),
        (via((0.0, 0.0), (0.0, 0.1)), "must end at zero in every joint"),
        (via((0.0, 0.0)), "two via points or more"),
        (via((0.0, 0.0), (0.0, 0.0), T=0.0), "times that increase"),
        (
            via((0.0, 0.0), (0.0, 2.1), (0.0, 0.0)),
            "via point 2: joint 2 at 2.1 is beyond its position bound of 2",
        ),
        (
            via((0.0, 0.0), (0.0, 0.2), (1.0, 0.2), (0.0, 0.0), T=0.5),
            "segment 2: joint 1 would reach velocity 3.75 and acceleration 23.09, "
            "its bounds are 2 and 8; give the segment at least",
        ),
    ],
)
def test_via_points_beyond_the_bounds_are_refused(path: Path, complaint: str) -> None:
    with pytest.raises(UsageFault, match=re.escape(complaint)):
        through(path, BOX)


@given(distance=st.floats(0.01, 10.0), limit=st.tuples(limits, limits))
@laws
def test_advice_on_a_fast_segment_is_good_advice(
    distance: float, limit: tuple[float, float]
) -> None:
    """The time it asks for, as printed, is enough."""
    box = Bounds(np.array([100.0]), *(np.array([x]) for x in limit))
    points = np.array([[0.0], [distance], [0.0]])
    with pytest.raises(UsageFault) as refused:
        through(Path(1e-3 * np.arange(3.0), points), box)
    advice = re.search(r"give the segment at least (\S+) s", str(refused.value))
    assert advice is not None
    through(Path(float(advice[1]) * np.arange(3.0), points), box)


# Refinement


@given(
    coefficients=st.lists(st.floats(-2.0, 2.0), min_size=6, max_size=6),
    period=st.floats(0.01, 2.0),
    ratio=st.integers(1, 12),
)
@laws
def test_refine_is_exact_for_a_quintic(
    coefficients: list[float], period: float, ratio: int
) -> None:
    polynomial = np.polynomial.Polynomial(coefficients)
    motion = [polynomial, polynomial.deriv(1), polynomial.deriv(2)]
    coarse, fine = (period * np.arange(4.0), period / ratio * np.arange(3.0 * ratio))
    refined = hermite.refine(*(x(coarse)[None] for x in motion), period, ratio)
    for power, (got, x) in enumerate(zip(refined, motion, strict=True)):
        # Rounding is that of the positions, and each derivative divides it by the period.
        scale = np.abs(motion[0](fine)).max() + 1.0
        atol = 1e-12 * scale / period**power
        np.testing.assert_allclose(got, x(fine)[None], rtol=1e-12, atol=atol)


def test_refine_keeps_the_joints_apart() -> None:
    both = np.random.default_rng(0).standard_normal((3, 2, 5))
    together = hermite.refine(*both, 0.1, 4)
    apart = [hermite.refine(*(x[joint : joint + 1] for x in both), 0.1, 4) for joint in range(2)]
    np.testing.assert_array_equal(together, np.concatenate(apart, axis=1))


def test_refine_rounds_alike_however_many_rows_there_are() -> None:
    """What makes a simulation independent of the chunks its reference comes in."""
    motion = np.random.default_rng(0).standard_normal((3, 2, 9))
    whole = hermite.refine(*motion, 0.1, 4)
    halves = [hermite.refine(*motion[:, :, rows], 0.1, 4) for rows in (np.s_[:5], np.s_[4:])]
    np.testing.assert_array_equal(np.concatenate(halves, axis=2), whole)


@pytest.mark.parametrize(
    ("duration", "segment", "seed"),
    [
        (49.45469588169772, (0.1050700641008129, 0.11002129259141089), 656663936),
        (42.946663441451236, (0.10781383143714836, 0.11756641333961333), 2086517997),
        (57.116161177179734, (0.11071862711508514, 0.11556174932410915), 1860640650),
    ],
)
def test_path_that_must_return_as_fast_as_it_can_is_made(
    duration: float, segment: tuple[float, float], seed: int
) -> None:
    """The furthest point to come back from is known to rounding only: numpy: high - low < 0."""
    box = Bounds(*np.ones((3, 1)))
    path = random_path(box, duration, segment, np.random.default_rng(seed))
    np.testing.assert_array_equal(path.points[-1], 0.0)
