"""An arm of two links for the tests of robots with a URDF."""

from __future__ import annotations

from pathlib import Path

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load

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
