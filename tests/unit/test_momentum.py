"""The momentum observer, against the closed form of its answer and its usual recursion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from scarid_cli.algorithms.regression.momentum import Observer, momentum
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

H = 1e-3
T = np.arange(2000) * H
FREQUENCY = 5.0
ROBOTS = ("scara2", "planar2-gravity", "samples/arm.toml")


def rows(robot_name: str, push: Array) -> tuple[Rows, Array]:
    """A motion whose torques are those of the a priori values less the external ones (samples)."""
    robot = load(robot_name)
    rng = np.random.default_rng(1)
    joints = len(robot.joints)
    rates, phases = rng.uniform(2.0, 6.0, joints)[:, None], rng.uniform(0.0, 6.0, joints)[:, None]
    q, dq, ddq = (
        np.sin(rates * T + phases),
        rates * np.cos(rates * T + phases),
        -(rates**2) * np.sin(rates * T + phases),
    )
    tau = robot.torques(robot.regressor(q, dq, ddq), robot.apriori) - push
    return rows_of(robot, np.stack((q, dq, ddq, tau)), np.arange(len(T)), H), robot.apriori


@pytest.mark.parametrize("name", ROBOTS)
def test_the_answer_to_a_push_is_that_of_a_low_pass(name: str) -> None:
    """A push of 1 from 1 s on: 1 - exp(-K (t - 1)), without any acceleration."""
    since = T - 1.0
    given, theta = rows(name, (since >= 0.0).astype(float))
    blind = replace(given, motion=given.motion * np.array([1.0, 1.0, np.nan, 1.0])[:, None, None])
    seen = Observer(load(name), FREQUENCY, H)(blind)
    external = seen.W @ theta - seen.y
    expected = np.where(since >= 0.0, 1.0 - np.exp(-2.0 * np.pi * FREQUENCY * since), 0.0)
    # The first sample of the step counts half; signs of dq jump between samples.
    settled = seen.scales[:, 0] > 0.0
    assert not settled[0]
    assert settled[400:].all()
    np.testing.assert_allclose(external[400:].T, np.tile(expected[400:], (given.y.shape[1], 1)),
                               atol=0.04)  # fmt: skip


@pytest.mark.parametrize("name", ROBOTS)
def test_momentum_is_the_mass_matrix_times_the_velocity(name: str) -> None:
    """M from the torques of unit accelerations, and dp/dt as the difference over time."""
    given, theta = rows(name, np.zeros(len(T)))
    robot = load(name)
    P, D = momentum(robot, given.motion)
    q, dq = given.motion[:2, :, 500:503]
    rest = np.zeros_like(q)
    still = robot.torques(robot.regressor(q, rest, rest), theta)
    M = [
        robot.torques(robot.regressor(q, rest, rest + unit[:, None]), theta) - still
        for unit in np.eye(len(q))
    ]
    p = np.einsum("jis,js->is", np.array(M), dq)
    np.testing.assert_allclose((P @ theta)[500:503].T, p, rtol=1e-10, atol=1e-12)
    rate = np.gradient(P @ theta, H, axis=0)
    np.testing.assert_allclose(rate[5:-5], (given.W @ theta + D @ theta)[5:-5], atol=2e-2)


def test_chunks_do_not_change_a_bit() -> None:
    given, _ = rows("scara2", np.zeros(len(T)))
    whole = Observer(load("scara2"), FREQUENCY, H)(given)
    observer = Observer(load("scara2"), FREQUENCY, H)
    parts = [observer(given.part(slice(a, a + 7))) for a in range(0, len(T), 7)]
    np.testing.assert_array_equal(np.concatenate([x.W for x in parts]), whole.W)
    np.testing.assert_array_equal(np.concatenate([x.y for x in parts]), whole.y)


def test_a_gap_begins_anew() -> None:
    given, theta = rows("scara2", np.zeros(len(T)))
    kept = np.r_[0:700, 1200:2000]
    seen = Observer(load("scara2"), FREQUENCY, H)(given.part(kept))
    assert not seen.scales[700:].all()
    np.testing.assert_allclose(seen.W @ theta, seen.y, atol=0.2)
