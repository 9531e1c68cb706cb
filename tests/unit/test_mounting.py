"""Axes, zeros and gravity that differ from the description."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from conftest import ROOT
from unit.arms import sines

from scarid_cli.algorithms.checks.model import Samples
from scarid_cli.algorithms.checks.mounting import Mounting, findings, mounted
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load

ARM = str(ROOT / "samples" / "robots" / "ur10e.toml")
UP = (0.0, 0.0, 9.81)


def robot_named(name: str) -> Robot:
    if name == ARM:
        pytest.importorskip("pinocchio")
    return load(name)


def log_of(robot: Robot, seed: int = 1) -> Samples:
    """Positions, derivatives, torques with 1 % noise and their derivatives, at 50 Hz."""
    q, dq, ddq = sines(len(robot.joints), 1500, 1.5, seed)
    tau = robot.torques(robot.regressor(q, dq, ddq), robot.apriori)
    noise = np.random.default_rng(seed).standard_normal(tau.shape)
    tau = tau + 0.01 * tau.std(axis=1, keepdims=True) * noise
    motion = np.stack((q, dq, ddq, tau, np.gradient(tau, 0.02, axis=1)))
    return Samples(motion, np.ones(tau.shape, dtype=bool), 1.0)


@pytest.mark.parametrize("name", ["scara2", "planar2-gravity", "emps", ARM])
def test_a_robot_is_mounted_as_it_is_described(name: str) -> None:
    robot = robot_named(name)
    found = mounted(robot, log_of(robot)).case
    assert found == Mounting.described(len(robot.joints))
    assert not findings(found)


@pytest.mark.parametrize(
    ("name", "joint", "degrees"),
    [("planar2-gravity", 1, 90.0), ("planar2-gravity", 1, -90.0), (ARM, 2, 90.0), (ARM, 4, 90.0)],
)
def test_a_zero_that_is_a_quarter_turn_away_is_found(name: str, joint: int, degrees: float) -> None:
    robot = robot_named(name)
    seen = log_of(robot)
    motion = seen.motion.copy()
    motion[0, joint - 1] -= np.deg2rad(degrees)
    (finding,) = findings(mounted(robot, replace(seen, motion=motion)).case)
    told = f"zeros: the model fits far better with joint {joint} at {degrees:.0f} degrees where"
    assert finding.text.startswith(told)


def test_neighbours_that_are_a_quarter_turn_off_in_opposite_directions_are_found() -> None:
    """The zero of an upper arm is upright, and the forearm is level: neither alone explains it."""
    robot = robot_named(ARM)
    seen = log_of(robot)
    motion = seen.motion.copy()
    motion[0, 1] -= 0.5 * np.pi
    motion[0, 2] += 0.5 * np.pi
    (finding,) = findings(mounted(robot, replace(seen, motion=motion)).case)
    assert "joint 2 at 90 degrees and joint 3 at -90 degrees where" in finding.figure


def test_a_robot_on_the_ceiling_is_found() -> None:
    robot = robot_named(ARM)
    assert robot.body
    hanging = replace(robot, body=replace(robot.body, gravity=UP))
    (finding,) = findings(mounted(robot, log_of(hanging)).case)
    assert finding.text.startswith("gravity: the model fits far better with gravity = [0, 0, 9.81]")


def test_torques_without_gravity_are_no_robot_on_a_wall() -> None:
    """As the commands of a controller that adds the torque of gravity."""
    robot = robot_named(ARM)
    assert robot.body
    bare = replace(robot, body=replace(robot.body, gravity=(0.0, 0.0, 0.0)))
    (finding,) = findings(mounted(robot, log_of(bare)).case)
    assert finding.text.startswith("gravity: the model fits far better without gravity; are these")


def test_an_axis_that_points_the_other_way_is_found() -> None:
    robot = robot_named("scara2")
    seen = log_of(robot)
    signs = np.array([1.0, -1.0])[:, None]
    found = mounted(robot, replace(seen, motion=signs * seen.motion)).case
    assert [finding.name for finding in findings(found)] == ["axes"]
    assert np.prod(found.signs) == -1.0  # either joint: the other one is then as described
