"""Rigid axes whose friction sticks, simulated by themselves: nothing of them is elastic."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import Result, seeds

from scarid_cli.arrays import Array

Scarid = Callable[..., Result]

URDF = """<robot name="axis"><link name="rail"/><link name="cart"><inertial>
<mass value="{mass}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="x" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" velocity="2" effort="800"/></joint></robot>"""
MASS, VISCOUS, COULOMB = 65.0, 40.0, 30.0  # kg, N s/m, N
STEP, SECONDS, EVERY = 1.25e-4, 30.0, 16  # s, s, steps of a row: 500 Hz
WORDS = ("oscillate", "yields", "older")  # of joints and gears that are elastic, of delays
BANDWIDTH = 2.0 * np.pi * 6.0  # rad/s, of the controller


def sticking(seed: int) -> Array:
    """Time, position and force (3, rows) of a cart that follows sines; it sticks as it turns."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, SECONDS, STEP)
    w = 2.0 * np.pi * 0.12 * (np.arange(1, 7) + rng.uniform(-0.15, 0.15, 6))
    size, phase = rng.normal(size=6) / np.arange(1, 7), rng.uniform(0.0, 2.0 * np.pi, 6)
    wanted = np.sin(np.outer(t, w) + phase) @ size
    speeds = np.cos(np.outer(t, w) + phase) @ (w * size)
    scale = 0.6 / np.ptp(wanted)
    q, v, force, rows = scale * wanted[0], scale * speeds[0], 0.0, []
    for k, (r, dr) in enumerate(zip(scale * wanted, scale * speeds, strict=True)):
        if k % (EVERY // 2) == 0:  # 1 kHz
            force = MASS * BANDWIDTH * (BANDWIDTH * (r - q) + 1.6 * (dr - v))
        if k % EVERY == 0:
            rows.append((t[k], q, force))
        pushed = MASS * v + STEP * force  # Coulomb friction takes at most so much of it
        new = np.sign(pushed) * max(abs(pushed) - STEP * COULOMB, 0.0) / (MASS + STEP * VISCOUS)
        q, v = q + 0.5 * STEP * (v + new), new
    found = np.array(rows).T
    found[1] = np.round(found[1], 5)
    found[2] += rng.normal(0.0, 2.0, len(rows))
    return found


def exact(seed: int) -> Array:
    """The same cart on sines as they are, whose friction jumps as it turns; it never sticks."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, SECONDS, EVERY * STEP)
    w, phase = 0.2 * np.pi * np.arange(1, 6), rng.uniform(0.0, 2.0 * np.pi, 5)
    size = np.array([0.5, 0.3, 0.3, 0.2, 0.2])
    angles = np.outer(t, w) + phase
    v, a = np.cos(angles) @ (size * w), -np.sin(angles) @ (size * w**2)
    force = MASS * a + VISCOUS * v + 3.0 * COULOMB * np.sign(v)
    force += rng.normal(0.0, 0.005 * np.std(force), len(t))
    return np.array([t, 2e-5 * np.round(np.sin(angles) @ size / 2e-5), force])


@pytest.mark.parametrize("log", [sticking, exact])
def test_a_rigid_axis_is_not_elastic(
    scarid: Scarid, tmp_path: Path, log: Callable[[int], Array]
) -> None:
    """Its encoder shakes the accelerations, and friction what is near a reversal.

    Before that was asked, 11 of 12 logs of either kind were said to be elastic.
    """
    robot, path, logs = tmp_path / "axis.urdf", tmp_path / "log.csv", seeds(3, 12)
    robot.write_text(URDF.format(mass=MASS))
    said = []
    for seed in logs:
        np.savetxt(path, log(seed).T, delimiter=",", header="t,q1,tau1", comments="", fmt="%.9g")
        result = scarid("identify", "--robot", robot, path, "-o", tmp_path / "p.parquet")
        assert result.status == 0
        said.append(result.err)
    assert sum(bool(set(WORDS) & set(text.split())) for text in said) <= len(logs) // 3
    assert not any("presliding" in text for text in said)  # nor does its friction build up
