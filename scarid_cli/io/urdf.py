"""Write other inertias, friction and motors into a URDF, and leave everything else as it was.

A URDF itself has no place for the inertia of a motor. Drake reads it in a <transmission>, and
Pinocchio in <rotor_params>, which is a part of its SRDF.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

import numpy as np

from scarid_cli.arrays import Array

DRAKE = "http://drake.mit.edu"  # the name that its own URDFs give the prefix
ElementTree.register_namespace("drake", DRAKE)
EFFORT = "hardware_interface/EffortJointInterface"


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
    motors: Mapping[str, tuple[float, float]] | None = None,
    table: Sequence[str] = (),
) -> str:
    """The URDF with new inertias of `links` by name, and a comment (`remark`).

    A link with None has no mass of its own: it is written as such, because a simulator may give a
    link without <inertial> 1 kg, or what its volume would weigh.

    `friction` has the viscous [N m s/rad or N s/m] and the Coulomb friction [N m or N] by the name
    of the joint, `motors` the inertia that the joint feels [kg m2 or kg] and the gear ratio. The
    lines of a `table` are a comment at the end.
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
    _set_motors(robot, motors or {})
    if table:
        lines = "".join(f"\n    {line}" for line in table).replace("--", "- -")
        _append(robot, ElementTree.Comment(f"{lines}\n  "))
    return ElementTree.tostring(robot, encoding="unicode", xml_declaration=True) + "\n"


def _set_motors(robot: ElementTree.Element, motors: Mapping[str, tuple[float, float]]) -> None:
    """Write each motor as a <transmission>, in the one that the joint has, and for Pinocchio."""
    known = {
        own.get("name"): transmission
        for transmission in robot.findall("transmission")
        for own in transmission.findall("joint")
    }
    rotors = ElementTree.Element("rotor_params")
    for joint, (inertia, gear) in motors.items():
        transmission = known.get(joint)
        if transmission is None:
            transmission = _transmission(robot, joint)
        actuator = _child(transmission, "actuator")
        reduction = _child(actuator, "mechanicalReduction")
        if gear != 1.0 or not (reduction.text or "").strip():
            reduction.text = _text(gear)
        gear = float(reduction.text or gear)
        rotor = _text(inertia / gear**2)
        _child(actuator, f"{{{DRAKE}}}rotor_inertia").set("value", rotor)
        _child(actuator, f"{{{DRAKE}}}gear_ratio").set("value", _text(gear))
        own = {"name": joint, "mass": rotor, "gear_ratio": _text(gear)}
        ElementTree.SubElement(rotors, "joint", own)
    if motors:
        ElementTree.indent(rotors, level=1)
        _append(robot, rotors)


def _transmission(robot: ElementTree.Element, joint: str) -> ElementTree.Element:
    """A new <transmission> of a joint, as ROS wants it."""
    made = ElementTree.Element("transmission", name=f"{joint}_transmission")
    kind = ElementTree.SubElement(made, "type")
    kind.text = "transmission_interface/SimpleTransmission"
    for tag, name in (("joint", joint), ("actuator", f"{joint}_motor")):
        interface = ElementTree.SubElement(
            ElementTree.SubElement(made, tag, name=name), "hardwareInterface"
        )
        interface.text = EFFORT
    ElementTree.SubElement(made[-1], "mechanicalReduction")
    for tag in ("rotor_inertia", "gear_ratio"):
        ElementTree.SubElement(made[-1], f"{{{DRAKE}}}{tag}")
    ElementTree.indent(made, level=1)
    _append(robot, made)
    return made


def _append(robot: ElementTree.Element, element: Any) -> None:
    """Add an element at the end, indented as those before it are."""
    end = robot[-1].tail
    robot[-1].tail = robot.text
    robot.append(element)
    element.tail = end


def _set_inertial(link: ElementTree.Element, inertial: Inertial | None) -> None:
    inertial = inertial or Inertial(0.0, np.zeros(3), np.zeros((3, 3)))
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
