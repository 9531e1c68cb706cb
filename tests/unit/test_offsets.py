"""Offsets of the torques: found where the log has them and the robot has no parameter for them."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import seeds
from scipy.stats import binom

from scarid_cli.algorithms.effects.offsets import offsets, with_offsets
from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

SCARA, PENDULUM = load("scara2"), load("planar2-gravity")
H = 0.005  # s
NOISE = np.array([0.3, 0.02])  # N m


def motion(samples: int = 4000) -> Array:
    """Positions, velocities and accelerations (3, 2, samples) of sums of sines."""
    t = np.arange(samples) * H
    q, dq, ddq = np.zeros((3, 2, samples))
    for joint, size, frequency in ((0, 0.8, 0.31), (0, 0.3, 0.83), (1, 0.7, 0.47), (1, 0.3, 1.1)):
        w = 2.0 * np.pi * frequency
        q[joint] += size * np.sin(w * t + joint)
        dq[joint] += size * w * np.cos(w * t + joint)
        ddq[joint] -= size * w * w * np.sin(w * t + joint)
    return np.stack((q, dq, ddq))


def log(offset: tuple[float, float] = (0.0, 0.0), seed: int = 0, robot: object = SCARA) -> Rows:
    """Rows of a log whose torques have an offset [N m] and white noise."""
    true = motion()
    torque = robot.torques(robot.regressor(*true), robot.apriori)  # type: ignore[attr-defined]
    noise = np.random.default_rng(seed).standard_normal(torque.shape)
    seen = torque + np.array(offset)[:, None] + NOISE[:, None] * noise
    return rows_of(robot, np.stack((*true, seen)), np.arange(4000), H)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("offset", "joints"),
    [((0.0, 0.0), ()), ((0.0, 0.02), (1,)), ((0.3, 0.0), (0,)), ((-0.3, 0.02), (0, 1))],
)
def test_the_joints_with_an_offset_are_found(
    offset: tuple[float, float], joints: tuple[int, ...]
) -> None:
    assert offsets(log(offset), SCARA) == joints


def test_noise_is_seldom_called_an_offset() -> None:
    """1 % are expected; more than these, 6 of 200, come by chance once in two hundred times."""
    logs = seeds(60, 200)
    found = sum(bool(offsets(log(seed=seed), SCARA)) for seed in logs)
    assert found <= binom.ppf(0.995, len(logs), 0.01)


def test_an_offset_that_the_robot_has_is_none_of_the_log() -> None:
    assert offsets(log((5.0, 5.0), robot=PENDULUM), PENDULUM) == ()


def test_an_offset_of_rounding_is_none() -> None:
    rows = log()
    exact = rows_of(SCARA, rows.motion, rows.at, H)
    exact.y[:] = exact.W @ SCARA.apriori + 1e-6
    assert offsets(exact, SCARA) == ()


def test_the_columns_are_those_of_the_joints() -> None:
    rows = log()
    wide = with_offsets(rows, (1,))
    np.testing.assert_array_equal(wide.W[:, :, :-1], rows.W)
    np.testing.assert_array_equal(wide.W[:, :, -1], np.tile([0.0, 1.0], (rows.samples, 1)))
    assert with_offsets(rows, ()) is rows
