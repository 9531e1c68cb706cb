"""Write other inertias and friction into a URDF, and leave everything else as it was."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], centre of mass [m] and inertia about it [kg m2], in the frame of the link."""

    mass: float
    centre: Array
    inertia: Array

    @classmethod
    def of(cls, mass: float, moments: Array, inertia: Array) -> Inertial:
        """From first moments [kg m] and the inertia [kg m2] about the origin of the link."""
        c = moments / mass
        return cls(mass, c, inertia - mass * (c @ c * np.eye(3) - np.outer(c, c)))


def rewritten(
    text: str,
    links: Mapping[str, Inertial | None],
    friction: Mapping[str, tuple[float, float]],
    remark: str,
) -> str:
    """The URDF with new inertias of `links` by name, None to remove one, and a comment (`remark`).

    `friction` has the viscous [N m s/rad or N s/m] and the Coulomb friction [N m or N] by the name
    of the joint.
    """
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    robot = ElementTree.fromstring(text, parser=parser)
    robot.insert(0, ElementTree.Comment(f" {remark.replace('--', '- -')} "))
    robot[0].tail = robot.text
    for link in robot.iter("link"):
        name = link.get("name", "")
        if name in links:
            _set_inertial(link, links[name])
    for joint in robot.findall("joint"):
        if joint.get("name") in friction:
            viscous, coulomb = friction[joint.get("name", "")]
            _child(joint, "dynamics").attrib.update(damping=_text(viscous), friction=_text(coulomb))
    return ElementTree.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


def _set_inertial(link: ElementTree.Element, inertial: Inertial | None) -> None:
    if inertial is None:
        for old in link.findall("inertial"):
            link.remove(old)
        return
    element = _child(link, "inertial")
    xyz = " ".join(_text(x) for x in inertial.centre)
    _child(element, "origin").attrib.update(xyz=xyz, rpy="0 0 0")
    _child(element, "mass").set("value", _text(inertial.mass))
    axes = "xyz"
    for row in range(3):
        for column in range(row, 3):
            key = f"i{axes[row]}{axes[column]}"
            _child(element, "inertia").set(key, _text(inertial.inertia[row, column]))


def _child(parent: ElementTree.Element, tag: str) -> ElementTree.Element:
    found = parent.find(tag)
    if found is None:
        found = ElementTree.SubElement(parent, tag)
        if len(parent) > 1:  # indented as its neighbours are
            found.tail, parent[-2].tail = parent[-2].tail, parent.text
    return found


def _text(value: float) -> str:
    return repr(float(value))
