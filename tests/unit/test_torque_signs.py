"""The signs of the torques with which a model explains a log, against a fit for each of them."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from unit.arms import seven_axes

from scarid_cli.algorithms.checks.model import Samples, columns, solved, torque_signs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array


@pytest.fixture(scope="module")
def seven(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    pytest.importorskip("pinocchio")
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(seven_axes())
    return load(str(path))


def samples_of(robot: Robot, signs: Array, rng: np.random.Generator) -> Samples:
    """Torques of the robot with these signs and noise, in arbitrary states of motion."""
    joints = len(robot.joints)
    states = rng.standard_normal((3, joints, 600))
    torque = robot.torques(robot.regressor(*states), robot.apriori)
    size = torque.std(axis=1, keepdims=True)
    tau = signs[:, None] * (torque + 0.1 * size * rng.standard_normal(torque.shape))
    motion = np.stack((*states, tau, np.zeros_like(tau)))
    return Samples(motion, np.ones(tau.shape, dtype=np.bool_), 1.0)


@pytest.mark.parametrize("seed", range(3))
def test_the_signs_are_those_that_leave_least(seed: int, seven: Robot) -> None:
    rng = np.random.default_rng(seed)
    signs = np.append(1.0, rng.choice([1.0, -1.0], 6))
    samples = samples_of(seven, signs, rng)
    found = torque_signs(seven, samples)
    assert found == tuple(signs)
    wide, tau = columns(seven, samples.motion), samples.motion[3]

    def left(s: tuple[int, ...]) -> float:
        turned = np.array(s)[:, None] * tau
        return float(solved(wide, turned, samples.counts).residuals.sum())

    others = [(1, *s) for s in product((1, -1), repeat=6)]
    assert left(found) == min(map(left, others))
