"""An arm of two links and one of seven for the tests of robots with a URDF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.arrays import Array

URDF = """<robot name="two">
  <link name="base"/>
  <joint name="a" type="revolute"><parent link="base"/><child link="one"/>
    <origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
  <link name="one"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.3"/></inertial></link>
  <joint name="b" type="TYPE"><parent link="one"/><child link="two"/>
    <origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="9" velocity="9"/></joint>
  <link name="two"><inertial><origin xyz="0.1 0 0.05"/><mass value="1"/>
    <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.03"/></inertial></link>
</robot>"""

# A hand on link two: two fingers, the second of which mimics the first.
FINGERS = "".join(
    f"""
  <joint name="{name}" type="prismatic"><parent link="two"/><child link="{name} finger"/>
    <axis xyz="0 1 0"/><limit lower="0" upper="0.04" effort="9" velocity="1"/>{mimic}</joint>
  <link name="{name} finger"><inertial><mass value="0.1"/>
    <inertia ixx="1e-5" ixy="0" ixz="0" iyy="1e-5" iyz="0" izz="1e-5"/></inertial></link>"""
    for name, mimic in (("left", ""), ("right", '<mimic joint="left" offset="0.02"/>'))
)


def described_arm(urdf: str, tmp_path: Path, lines: str) -> Robot:
    path = tmp_path / "robot.toml"
    path.write_text(f"title = 'two'\nurdf = '{urdf}'\n{lines}\n")
    return load(str(path))


def seven_axes(centre: str = "0.01 0.02 0.1", axes: int = 7) -> str:
    """The URDF of an arm whose axes are vertical and horizontal in turn, its links ever lighter.

    Seven of them, or the last ones of these.
    """
    parts = ['<robot name="seven"><link name="l0"/>']
    for i in range(1, axes + 1):
        m = axes + 1 - i
        parts.append(
            f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="0 0 0.2"/><axis xyz="{"0 0 1" if i % 2 else "0 1 0"}"/>'
            '<limit lower="-3" upper="3" effort="99" velocity="9"/></joint>'
            f'<link name="l{i}"><inertial><origin xyz="{centre}"/><mass value="{m}"/>'
            f'<inertia ixx="{0.01 * m}" ixy="0" ixz="0" iyy="{0.01 * m}" iyz="0"'
            f' izz="{0.004 * m}"/></inertial></link>'
        )
    return "".join([*parts, "</robot>"])


def turned_axes(angles: Sequence[Sequence[float]]) -> str:
    """The URDF of an arm whose joints turn about z, each turned by roll, pitch and yaw [rad]."""
    parts = ['<robot name="turned"><link name="l0"/>']
    for i, turn in enumerate(angles, start=1):
        parts.append(
            f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="0 {0.2 * (i % 2)} {0.2 * (1 - i % 2)}"'
            f' rpy="{" ".join(map(str, turn))}"/><axis xyz="0 0 1"/>'
            '<limit lower="-3" upper="3" effort="99" velocity="9"/></joint>'
            f'<link name="l{i}"><inertial><origin xyz="0.01 0.02 0.1"/><mass value="1"/>'
            '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
        )
    return "".join([*parts, "</robot>"])


def long_chain(joints: int) -> str:
    """The URDF of a chain of equal links, whose axes point along x, y and z in turn."""
    parts = ['<robot name="chain"><link name="l0"/>']
    for i in range(1, joints + 1):
        axis = " ".join("1" if i % 3 == k else "0" for k in range(3))
        parts.append(
            f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/>'
            f'<origin xyz="0.2 0 0.1" rpy="0.1 0 0.2"/><axis xyz="{axis}"/>'
            '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
            f'<link name="l{i}"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>'
            '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
        )
    return "".join([*parts, "</robot>"])


def sines(joints: int, samples: int, amplitude: float, seed: int) -> Array:
    """Position, velocity and acceleration (3, joints, samples): three sines per joint, 50 Hz."""
    rng = np.random.default_rng(seed)
    t = 0.02 * np.arange(samples)
    w = 2.0 * np.pi * rng.uniform(0.1, 0.5, (joints, 3, 1))
    phase = w * t + rng.uniform(0.0, 2.0 * np.pi, (joints, 3, 1))
    a = amplitude / 3.0 * rng.uniform(0.2, 1.0, (joints, 3, 1))
    waves = (a * np.sin(phase), a * w * np.cos(phase), -a * w * w * np.sin(phase))
    return np.array([wave.sum(axis=1) for wave in waves])
