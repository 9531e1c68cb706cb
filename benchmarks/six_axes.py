"""Simulated logs of six-axis arms of ten kilograms, before and after something has changed.

Each arm has a geometry, link inertias, friction and motor inertias of its own, drawn by its number.
Its torques are W theta along smooth random motions, plus noise of which half is white and half is
correlated over a tenth of a second. Positions are those of an encoder of 17 bits.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array
from scarid_cli.io.table import Metadata, Table, doubles
from scarid_cli.stages.differentiate import matched

PERIOD, DURATION = 0.005, 20.0  # s
JOINTS = 6
ENCODER = 2.0 * np.pi / 2**17  # rad
NOISE = 0.06  # of the rms torque of a joint
CORRELATION = 0.1  # s
SHARES = np.array([0.2, 0.3, 0.22, 0.13, 0.09, 0.06])  # of 10 kg, link by link
FRICTION = np.array([1.0, 1.0, 0.7, 0.15, 0.12, 0.1])  # of the torques below
VISCOUS, COULOMB, MOTOR, OFFSET = 4.0, 3.0, 0.6, 0.3  # N m s/rad, N m, kg m2, N m
AXES = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")


@dataclass(frozen=True)
class Arm:
    """An arm: its robot, the true values of its base parameters, and its noise (joints) [N m]."""

    robot: Robot
    theta: Array
    noise: Array


def arm(number: int) -> Arm:
    """The arm of this number."""
    rng = np.random.default_rng([6, number])
    with TemporaryDirectory() as folder:
        (Path(folder) / "arm.urdf").write_text(_urdf(rng))
        (Path(folder) / "arm.toml").write_text(_description(rng))
        robot = load(f"{folder}/arm.toml")
        typical = robot.torques(robot.regressor(*motion(rng)), robot.apriori)
    size = NOISE * np.sqrt(np.mean(typical**2, axis=1))
    return Arm(replace(robot, name="six axes"), robot.apriori, size)


def _urdf(rng: np.random.Generator) -> str:
    parts = ['<robot name="six"><link name="l0"/>']
    offsets = [
        (0, 0, 0.15),
        (0, 0.1, 0.08),
        (0, -0.05, 0.35),
        (0.1, 0, 0.06),
        (0.22, 0, 0),
        (0.08, 0, 0),
    ]
    lengths = [0.1, 0.35, 0.1, 0.22, 0.08, 0.05]
    spins = rng.uniform(0.8, 1.25, (JOINTS, 3))
    for i, (axis, offset, share, length) in enumerate(
        zip(AXES, offsets, SHARES, lengths, strict=True), start=1
    ):
        m = 10.0 * share * rng.uniform(0.85, 1.15)
        along = np.array([0.0, 0.0, 1.0] if i <= 2 else [1.0, 0.0, 0.0]) * 0.45 * length
        centre = along + rng.normal(0.0, 0.01, 3)
        place = np.array(offset) * spins[i - 1]
        small = m * (0.04**2) * rng.uniform(0.7, 1.3, 3) + m * length**2 / 12.0
        parts.append(
            f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="{_row(place)}"/><axis xyz="{axis}"/>'
            '<limit lower="-3" upper="3" effort="200" velocity="4"/></joint>'
            f'<link name="l{i}"><inertial><origin xyz="{_row(centre)}"/><mass value="{m}"/>'
            f'<inertia ixx="{small[0]}" ixy="0" ixz="0" iyy="{small[1]}" iyz="0"'
            f' izz="{small[2]}"/></inertial></link>'
        )
    return "".join([*parts, "</robot>"])


def _row(values: Array) -> str:
    return " ".join(f"{x:.6f}" for x in values)


def _description(rng: np.random.Generator) -> str:
    lines = ['title = "six axes"', 'urdf = "arm.urdf"']
    for size in FRICTION:
        fv, fs, ia, off = (
            size * np.array([VISCOUS, COULOMB, MOTOR, OFFSET]) * rng.uniform(0.7, 1.3, 4)
        )
        lines += [
            "[[joint]]",
            f"terms = {{ inertia = {ia}, viscous = {fv}, coulomb = {fs}, offset = {off} }}",
        ]
    return "\n".join(lines)


def motion(rng: np.random.Generator) -> Array:
    """Position, velocity, acceleration (3, joints, samples): five sines for each joint."""
    t = PERIOD * np.arange(round(DURATION / PERIOD))
    w = 2.0 * np.pi * rng.uniform(0.05, 0.6, (JOINTS, 5, 1))
    phase = w * t + rng.uniform(0.0, 2.0 * np.pi, (JOINTS, 5, 1))
    a = rng.uniform(0.2, 1.0, (JOINTS, 5, 1)) * 0.45
    waves = (a * np.sin(phase), a * w * np.cos(phase), -a * w * w * np.sin(phase))
    return np.array([wave.sum(axis=1) for wave in waves])


def noise(rng: np.random.Generator, samples: int) -> Array:
    """Unit noise (joints, samples), half of its variance white, half an autoregression."""
    white = rng.standard_normal((2, JOINTS, samples + 200))
    keep = np.exp(-PERIOD / CORRELATION)
    slow = np.zeros(JOINTS)
    coloured = np.empty((JOINTS, samples + 200))
    for k in range(samples + 200):
        slow = keep * slow + np.sqrt(1.0 - keep**2) * white[0, :, k]
        coloured[:, k] = slow
    return np.sqrt(0.5) * (white[1] + coloured)[:, 200:]


def log(
    made: Arm,
    theta: Array,
    seed: tuple[int, ...],
    gains: Array | None = None,
    delay: int = 0,
    zeros: Array | None = None,
) -> Table:
    """A measurement: the torques are those of theta times the gains, and late by some samples.

    The positions are too large by the zeros [rad].
    """
    rng = np.random.default_rng(list(seed))
    q, dq, ddq = motion(rng)
    tau = made.robot.torques(made.robot.regressor(q, dq, ddq), theta)
    tau = tau + made.noise[:, None] * noise(rng, q.shape[1])
    if gains is not None:
        tau = tau * gains[:, None]
    if zeros is not None:
        q = q + zeros[:, None]
    q = np.round(q / ENCODER) * ENCODER
    if delay:
        q, tau = q[:, delay:], tau[:, :-delay]
    return table(q, tau)


def table(q: Array, tau: Array) -> Table:
    """A measurement from positions and torques (joints, samples)."""
    names = [f"q{i}" for i in range(1, len(q) + 1)] + [f"tau{i}" for i in range(1, len(q) + 1)]
    arrays = [doubles(PERIOD * np.arange(q.shape[1])), *map(doubles, [*q, *tau])]
    batch = pa.RecordBatch.from_arrays(arrays, ["t", *names])
    return Table("log", batch.schema, Metadata(kind="measurement", period=PERIOD), iter([batch]))


def differentiated(measured: Table) -> Table:
    """The motion that the default soft sensor estimates."""
    kalman = DIFFERENTIATORS.load("kalman")()
    joints = sum(name.startswith("q") for name in measured.columns)
    return matched(measured, [kalman] * joints)


def loaded(made: Arm, mass: float, place: Array) -> Array:
    """The base parameters of the arm with a point mass [kg] on its last link, at a place [m]."""
    x, y, z = place
    added = {
        "Ixx": y * y + z * z, "Iyy": x * x + z * z, "Izz": x * x + y * y,
        "Ixy": -x * y, "Ixz": -x * z, "Iyz": -y * z, "mx": x, "my": y, "mz": z, "m": 1.0,
    }  # fmt: skip
    moved = {f"{name}{JOINTS}": mass * value for name, value in added.items()}
    return made.theta + np.array(
        [sum(x * moved.get(name, 0.0) for name, x in p.parts) for p in made.robot.parameters]
    )


def rubbed(made: Arm, factor: float, joint: int | None = None) -> Array:
    """The base parameters with the friction of one joint (from 1), or of all, times a factor."""
    theta = made.theta.copy()
    for i, p in enumerate(made.robot.parameters):
        if p.term.NAME in ("viscous", "coulomb") and joint in (None, *p.term.joints):
            theta[i] *= factor
    return theta
