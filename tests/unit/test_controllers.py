"""The controllers of simulated robots against their equations, and the gains found for them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from unit.arms import described_arm, seven_axes
from unit.plants import closed_loop, reference

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.errors import UsageFault

TICKS = 400


FRICTION = ", viscous = 0.2, coulomb = 0.3, offset = 0.1"


def seven(folder: Path, control: str = "", friction: str = FRICTION) -> Robot:
    (folder / "seven.urdf").write_text(seven_axes())
    terms = f"[[joint]]\nterms = {{ inertia = 0.1{friction} }}\n"
    return described_arm("seven.urdf", folder, 7 * terms + control)


@pytest.mark.parametrize("kind", ["pd", "pid", "pd-gravity", "computed-torque"])
def test_torque_is_that_of_its_law(kind: str, tmp_path: Path) -> None:
    """By Pinocchio, from what the encoders read; the robot itself is heavier than the model."""
    known = seven(tmp_path)
    heavier = replace(
        known, parameters=tuple(replace(p, apriori=1.2 * p.apriori) for p in known.parameters)
    )
    heavier = replace(
        heavier, joints=tuple(replace(joint, torque_limit=np.inf) for joint in heavier.joints)
    )
    found = law(known, kind)
    gains = {"kp": found.kp, "kd": found.kd, "ki": found.ki, "kind": kind}
    loop = closed_loop(heavier, **gains, velocity_cutoff=20.0, apriori=known)
    q_ref, dq_ref, ddq_ref = reference(7, TICKS)
    log = loop.step(loop.init(q_ref[:, 0]), q_ref, dq_ref, ddq_ref)[1]
    assert known.body
    model = known.body.model
    data, smooth = model.createData(), np.exp(-2.0 * np.pi * 20.0 / 1000.0)
    dq, integral = np.zeros(7), np.zeros(7)
    for k in range(TICKS):
        q = log.q[:, k].copy()
        dq = smooth * dq + (1.0 - smooth) * (q - log.q[:, max(k - 1, 0)]) * 1000.0
        integral += found.ki * (q_ref[:, k] - q) / 1000.0
        tau = found.kp * (q_ref[:, k] - q) + found.kd * (dq_ref[:, k] - dq) + integral
        if kind == "pd-gravity":
            tau += pinocchio.computeGeneralizedGravity(model, data, q)
        if kind == "computed-torque":
            a = ddq_ref[:, k] + tau
            tau = pinocchio.rnea(model, data, q, dq, a) + 0.1 * a + 0.1
            tau += 0.2 * dq_ref[:, k] + 0.3 * np.sign(dq_ref[:, k])
        np.testing.assert_allclose(log.tau[:, k], tau, rtol=1e-10, atol=1e-8)


def test_computed_torque_with_the_true_model_has_the_error_of_its_two_poles(tmp_path: Path) -> None:
    """From an error e0 at rest, critically damped: e0 (1 + w t) exp(-w t), but for sampling."""
    robot = seven(tmp_path, friction="")
    found = law(robot, bandwidth=2.0)
    assert found.kind == "computed-torque"
    rate, ticks = 20000.0, 8000
    loop = closed_loop(robot, kp=found.kp, kd=found.kd, kind=found.kind, control_rate=rate)
    t, still = np.arange(ticks) / rate, np.zeros((7, ticks))
    log = loop.step(loop.init(np.zeros(7)), still + 0.05, still, still)[1]
    omega = 2.0 * np.pi * 2.0
    expected = 0.05 * (1.0 + omega * t) * np.exp(-omega * t)
    np.testing.assert_allclose(0.05 - log.q_true, np.tile(expected, (7, 1)), atol=1e-4)


def test_gains_are_those_of_the_description_unless_given(tmp_path: Path) -> None:
    robot = load("scara2")
    own = law(robot)
    assert own.kind == "pid"
    np.testing.assert_array_equal(own.kp, [800.0, 25.0])
    np.testing.assert_array_equal(law(robot, kp=np.ones(2)).kp, 1.0)
    np.testing.assert_array_equal(law(robot, kp=np.ones(2)).kd, own.kd)
    np.testing.assert_array_equal(law(robot, "pd-gravity").kd, own.kd)
    # Gains of torques mean nothing to a controller of accelerations.
    np.testing.assert_allclose(law(robot, "computed-torque").kp, (10.0 * np.pi) ** 2)
    np.testing.assert_allclose(law(robot, "computed-torque", 2.0).kd, 8.0 * np.pi)
    stated = seven(tmp_path, "[control]\nkind = 'pd-gravity'\nbandwidth = 3.0\n")
    assert law(stated).kind == "pd-gravity"
    np.testing.assert_array_equal(law(stated).kp, law(stated, bandwidth=3.0).kp)
    np.testing.assert_array_equal(law(stated, "pd").ki, 0.0)
    assert np.all(law(stated, "pid").ki > 0.0)


@pytest.mark.parametrize(
    ("control", "complaint"),
    [
        ("kind = 'lqr'", "kind 'lqr'; choose pd or pid or pd-gravity or computed-torque"),
        ("gain = 3.0", r"gain is not a key of \[control\]"),
        ("kp = [1.0]\nkd = [1.0]\nki = [0.0]\nvelocity_cutoff = 9.0", "kp has 1 values for 7"),
        ("kp = [1.0]\nbandwidth = 2.0", "gains and a bandwidth; give one or the other"),
    ],
)
def test_controller_without_sense_is_refused(control: str, complaint: str, tmp_path: Path) -> None:
    with pytest.raises(UsageFault, match=complaint):
        seven(tmp_path, f"[control]\n{control}\n")


def test_bandwidth_that_is_not_positive_is_refused() -> None:
    with pytest.raises(UsageFault, match="--bandwidth: must be positive"):
        law(load("scara2"), bandwidth=-1.0)
