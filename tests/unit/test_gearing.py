"""Clocks, gears and couplings that a log's torques tell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from unit.test_mounting import log_of

from scarid_cli.algorithms.checks.gearing import Gearing, findings, geared
from scarid_cli.algorithms.checks.model import Samples
from scarid_cli.algorithms.robots.reading import load

ARM = load("planar2-gravity")
SCARA = load("scara2")
NONE = (0.0, 0.0)


def logged(samples: Samples, case: Gearing) -> Samples:
    """What a log has of these samples whose joints are seen as `case` says."""
    q, dq, ddq, tau, slope = samples.motion.copy()
    q -= np.array(case.zeros)[:, None]
    for x in (q, dq, ddq):
        for j, times in enumerate(case.behind[1:], start=1):
            x[j] += times * x[j - 1]
        x /= np.array(case.scales)[:, None]
    for x in (tau, slope):
        for j in reversed(range(len(x) - 1)):
            x[j] -= case.carried[j] * x[j + 1]
    dq, ddq, slope = dq * case.time, ddq * case.time**2, slope * case.time
    return replace(samples, motion=np.stack((q, dq, ddq, tau, slope)))


CASES = {
    "time is 0.5 times": Gearing(0.5, (1.0, 1.0), (0, 0), (0, 0), NONE),
    "time is 2 times": Gearing(2.0, (1.0, 1.0), (0, 0), (0, 0), NONE),
    "time is 1.3 times": Gearing(1.3, (1.0, 1.0), (0, 0), (0, 0), NONE),
    "position of joint 2 times 0.5 (1/2)": Gearing(1.0, (1.0, 0.5), (0, 0), (0, 0), NONE),
    "positions of joints 1, 2 times 0.02 (1/50)": Gearing(1.0, (0.02, 0.02), (0, 0), (0, 0), NONE),
    "position of joint 2 less that of joint 1": Gearing(1.0, (1.0, 1.0), (0, 1), (0, 0), NONE),
    "position of joint 2 plus that of joint 1": Gearing(1.0, (1.0, 1.0), (0, -1), (0, 0), NONE),
    "torque of joint 1 plus that of joint 2": Gearing(1.0, (1.0, 1.0), (0, 0), (1, 0), NONE),
    "joint 1 at 17.2 degrees where": Gearing(1.0, (1.0, 1.0), (0, 0), (0, 0), (0.3, 0.0)),
    "joint 1 at -40.1 degrees where": Gearing(1.0, (1.0, 1.0), (0, 0), (0, 0), (-0.7, 0.0)),
    "joint 1, and the torque of joint 1 plus": Gearing(1.0, (1.0, 1.0), (0, 1), (1, 0), NONE),
}


@given(
    st.floats(0.1, 10.0),
    st.tuples(*[st.floats(0.1, 10.0)] * 2),
    st.sampled_from([-1, 0, 1]),
    st.sampled_from([-1, 0, 1]),
    st.floats(-3.0, 3.0),
)
@settings(max_examples=25)
def test_what_is_seen_is_what_the_joints_do(
    time: float, scales: tuple[float, float], behind: int, carried: int, zero: float
) -> None:
    case = Gearing(time, scales, (0, behind), (carried, 0), (zero, 0.0))
    samples = log_of(ARM)
    seen = case.seen(logged(samples, case)).motion
    np.testing.assert_allclose(seen, samples.motion, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("told", CASES)
def test_what_explains_the_torques_is_found_and_told(told: str) -> None:
    case = CASES[told]
    found = geared(ARM, logged(log_of(ARM), case)).case
    assert (found.behind, found.carried) == (case.behind, case.carried)
    assert found.time == pytest.approx(case.time, rel=0.01)
    assert found.zeros == pytest.approx(case.zeros, abs=0.01)
    assert found.scales == pytest.approx(case.scales, rel=0.01)
    (finding,) = findings(case)
    assert told in finding.figure


@pytest.mark.parametrize("robot", [ARM, SCARA], ids=["gravity", "none"])
@pytest.mark.parametrize("seed", range(5))
def test_nothing_is_found_in_a_log_that_is_right(robot: object, seed: int) -> None:
    own = ARM if robot is ARM else SCARA
    found = geared(own, log_of(own, seed)).case
    assert found == Gearing.none(2)
    assert not findings(found)


def test_without_gravity_no_torque_tells_the_clock() -> None:
    case = Gearing(2.0, (1.0, 1.0), (0, 0), (0, 0), NONE)
    assert geared(SCARA, logged(log_of(SCARA), case)).case.same
