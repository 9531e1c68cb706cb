"""Excitation: within its limits whatever is asked, from home to home, exact between samples."""

from __future__ import annotations

import re
from math import ceil, floor

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.algorithms.trajectories.via import ViaPath
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

# Limits hold by construction, but for the rounding of a few multiplications.
ROUNDING = 1.0 + 1e-12

sizes = st.floats(1e-3, 1e3)
lengths = st.floats(0.1, 5.0)
seeds = st.integers(0, 2**32 - 1)
laws = settings(max_examples=60, deadline=None)


@st.composite
def limits(draw: st.DrawFn, joints: int | None = None) -> Limits:
    """Limits of one to three joints, whose intervals contain zero or not."""
    count = joints or draw(st.integers(1, 3))
    lower = np.array(draw(st.lists(st.floats(-10.0, 10.0), min_size=count, max_size=count)))
    rows = [draw(st.lists(sizes, min_size=count, max_size=count)) for _ in range(3)]
    room, dq, ddq = (np.array(row) for row in rows)
    return Limits(lower, lower + room, dq, ddq)


@st.composite
def homes(draw: st.DrawFn, limits: Limits) -> Array:
    """Any position within the limits, their ends included, or the default."""
    shares = st.lists(st.floats(0.0, 1.0), min_size=len(limits.dq), max_size=len(limits.dq))
    share = np.array(draw(shares))
    anywhere = (1.0 - share) * limits.lower + share * limits.upper
    home: Array = draw(
        st.sampled_from([limits.home, np.clip(anywhere, limits.lower, limits.upper)])
    )
    return home


@st.composite
def requests(draw: st.DrawFn) -> tuple[Limits, Array, float, Trajectory]:
    """A random motion, with what was asked of it: limits, home and duration."""
    box = draw(limits())
    home = draw(homes(box))
    name = draw(st.sampled_from(EXCITATIONS.names))
    excitation, shortest = EXCITATIONS.load(name), draw(lengths)
    given = {"shortest": shortest, "longest": shortest + draw(st.floats(0.0, 3.0))}
    settings = {key: given[key] for key in names_of(excitation) if key in given}
    least = 2.0 * shortest * (len(home) if name == "sequential" else 1)
    duration = draw(st.floats(least, least + 60.0))
    rng = np.random.default_rng(draw(seeds))
    return box, home, duration, excitation(**settings).trajectory(box, home, duration, rng)


def around_zero(joints: int, size: float = 1.0) -> Limits:
    """All limits of one size."""
    ones = np.full(joints, size)
    return Limits(-ones, ones, ones, ones)


def random_path(
    limits: Limits,
    duration: float,
    segment: tuple[float, float],
    seed: int,
    excitation: str = "quintic",
) -> ViaPath:
    method = EXCITATIONS.load(excitation)(*segment)
    rng = np.random.default_rng(seed)
    path: ViaPath = method.trajectory(limits, limits.home, duration, rng)
    return path


@given(request=requests())
@laws
def test_every_random_motion_keeps_its_limits_and_starts_and_ends_at_rest_at_home(
    request: tuple[Limits, Array, float, Trajectory],
) -> None:
    box, home, duration, trajectory = request
    starts_and_ends_at_rest_at_home(home, duration, trajectory)
    q, dq, ddq = trajectory.sample(np.linspace(0.0, duration, 2000))
    slack = 1e-12 * np.maximum(np.abs(box.lower), np.abs(box.upper))
    assert np.all(box.lower - slack <= q.T)
    assert np.all(box.upper + slack >= q.T)
    # Distances are rounded as positions are, and the derivatives with them.
    for signal, limit, power in ((dq, box.dq, 1), (ddq, box.ddq, 2)):
        rounding = 1e-14 * np.maximum(np.abs(box.lower), np.abs(box.upper)) * 60.0 / 0.1**power
        assert np.all(limit * ROUNDING + rounding >= np.abs(signal).T)


def starts_and_ends_at_rest_at_home(home: Array, duration: float, trajectory: Trajectory) -> None:
    assert trajectory.duration == duration
    q, dq, ddq = trajectory.sample(np.array([0.0, duration]))
    # The end is the last via point but one and the way to it: exact for a home at zero.
    np.testing.assert_allclose(q, np.column_stack((home, home)), rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal(q[home == 0.0], 0.0)
    np.testing.assert_array_equal([dq, ddq], 0.0)


@given(box=limits(), seed=seeds)
@laws
def test_a_quintic_is_at_rest_at_every_via_point(box: Limits, seed: int) -> None:
    path = random_path(box, 20.0, (0.5, 2.0), seed)
    q, dq, ddq = path.sample(path.times)
    np.testing.assert_allclose(q, path.points.T, rtol=0.0, atol=1e-12)
    np.testing.assert_array_equal([dq, ddq], 0.0)


@pytest.mark.parametrize(
    ("lower", "upper", "home"),
    [
        (-1.0, 2.0, 0.0),
        (-3.2, 1.0, -1.1),  # zero is nearer to a limit than a quarter of the interval
        (0.0, 0.04, 0.02),
        (-3.0, -1.0, -2.0),
        (1.0, 1.5, 1.25),
        (-np.inf, np.inf, 0.0),
        (0.0, np.inf, 0.0),
    ],
)
def test_home_is_zero_or_the_middle(lower: float, upper: float, home: float) -> None:
    joint = Joint("revolute", lower, upper, velocity_limit=1.0, acceleration_limit=1.0)
    assert Limits.of([joint]).home.tolist() == [home]


LIMITED = Limits(*np.array([[-1.0, -2.0], [0.5, -0.5], [2.0, 3.0], [4.0, 5.0]]))


@pytest.mark.parametrize(
    ("signal", "joint", "value", "complaint"),
    [
        (0, 0, 0.51, "the position of joint 1 is 0.51, allowed is -1 to 0.5"),
        (0, 1, 0.0, "the position of joint 2 is 0, allowed is -2 to -0.5"),
        (0, 1, np.nan, "the position of joint 2 is nan, allowed is -2 to -0.5"),
        (1, 0, -2.1, "the velocity of joint 1 is -2.1, allowed is at most 2"),
        (2, 1, 6.0, "the acceleration of joint 2 is 6, allowed is at most 5"),
    ],
)
def test_a_motion_that_leaves_its_limits_is_refused_where_it_does(
    signal: int, joint: int, value: float, complaint: str
) -> None:
    motion = np.zeros((3, 2, 10))
    motion[0, 1] = -1.0
    t = np.arange(10) * 0.1
    LIMITED.require(t, *motion)
    motion[signal, joint, 7] = value
    with pytest.raises(UsageFault, match=re.escape(f"at t = 0.7 s {complaint}")):
        LIMITED.require(t, *motion)


@given(
    shortest=lengths,
    more=st.floats(0.0, 3.0),
    excitation=st.sampled_from(["quintic", "sequential"]),
    beyond=st.floats(0.0, 60.0),
    seed=seeds,
)
@example(shortest=1.0, more=0.05, excitation="quintic", beyond=0.9, seed=0)
@laws
def test_segments_last_as_long_as_requested(
    shortest: float, more: float, excitation: str, beyond: float, seed: int
) -> None:
    """Whenever a whole number of them makes the duration: at least there and back, per joint."""
    joints = 3 if excitation == "sequential" else 1
    least, longest = 2 * joints, shortest + more
    duration = least * shortest + beyond
    assume(max(least, ceil(duration / longest)) <= floor(duration / shortest))
    path = random_path(around_zero(joints), duration, (shortest, longest), seed, excitation)
    T = np.diff(path.times)
    assert shortest * (1.0 - 1e-9) <= T.min()
    assert T.max() <= longest * (1.0 + 1e-9)


@given(box=limits(joints=3), seed=seeds)
@laws
def test_sequential_joints_move_one_at_a_time(box: Limits, seed: int) -> None:
    path = random_path(box, 20.0, (0.5, 2.0), seed, "sequential")
    moving = np.diff(path.points, axis=0) != 0.0
    assert np.all(moving.sum(axis=1) <= 1)
    assert np.all(moving.any(axis=0))


def test_same_seed_gives_the_same_path() -> None:
    first, same, other = (
        random_path(around_zero(2), 20.0, (0.5, 2.0), seed).points.tolist() for seed in (1, 1, 2)
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
        random_path(around_zero(1), duration, segment, 0)


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
    path = random_path(around_zero(1), duration, segment, seed)
    np.testing.assert_array_equal(path.points[-1], 0.0)
