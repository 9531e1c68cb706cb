"""The tree of joints and links that a URDF describes, read by Pinocchio (the extra `urdf`)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

from scarid_cli.algorithms.robots import values
from scarid_cli.errors import UsageFault

ENDLESS = 1e9  # rad: urdfdom does not read inf
MASSLESS = 1e-6  # kg: some URDFs give their frames a token mass


@dataclass(frozen=True)
class Tree:
    """A URDF as Pinocchio reads it, and what Pinocchio does not keep of it.

    `model` has all joints that move. `drivers` has the joint that each joint with a <mimic>
    follows, `offsets` where it is when that joint is at 0 [rad or m], `frames` the massless frames
    at the ends of links: their names, and the numbers of the joints that carry them.
    """

    model: Any
    drivers: dict[str, str]
    offsets: dict[str, float]
    frames: dict[str, int]


@cache
def read(path: str) -> Tree:
    """The URDF in a file."""
    try:
        import pinocchio
    except ImportError:
        raise UsageFault(f"{path}: a URDF needs Pinocchio: pip install 'scarid[urdf]'") from None
    if not Path(path).exists():
        raise UsageFault(f"{path}: no such file")
    try:
        tree = ElementTree.fromstring(Path(path).read_text("utf-8"))
        _turn_endless_joints_into_angles(tree)
        _drop_shapes(tree)
        model = pinocchio.buildModelFromXML(ElementTree.tostring(tree, encoding="unicode"))
        values.moderate(model.njoints - 1)
        mimics = {j.get("name", ""): m for j in tree.findall("joint") for m in j.findall("mimic")}
        drivers = {name: mimic.get("joint", "") for name, mimic in mimics.items()}
        offsets = {name: float(mimic.get("offset", "0")) for name, mimic in mimics.items()}
    except (RuntimeError, SyntaxError, ValueError) as error:
        raise UsageFault(f"{path}: not a URDF: {' '.join(str(error).split())}") from None
    if not model.nq or model.nq != model.nv:
        raise UsageFault(f"{path}: only revolute, continuous and prismatic joints are supported")
    tips = _massless_tips(tree)
    frames = {name: model.frames[model.getFrameId(name)].parentJoint for name in tips}
    return Tree(model, drivers, offsets, frames)


def _turn_endless_joints_into_angles(tree: ElementTree.Element) -> None:
    """Makes continuous joints revolute: their position is an angle, not a point of a circle."""
    for joint in tree.iter("joint"):
        if joint.get("type") == "continuous":
            joint.set("type", "revolute")
            limit = joint.find("limit")
            limit = ElementTree.SubElement(joint, "limit") if limit is None else limit
            for key, value in (("lower", -ENDLESS), ("upper", ENDLESS)):
                limit.set(key, str(value))
            for key in ("effort", "velocity"):
                limit.set(key, limit.get(key, "0"))


def _drop_shapes(tree: ElementTree.Element) -> None:
    """Drops what is not needed here; Pinocchio complains about shapes that it does not know."""
    for own in tree.findall("link"):
        for shape in (*own.findall("visual"), *own.findall("collision")):
            own.remove(shape)


def _massless_tips(tree: ElementTree.Element) -> Iterator[str]:
    """The links fixed to another that carry no further link and have no mass worth the name."""
    parents = {link(joint, "parent") for joint in tree.findall("joint")}
    masses = {own.get("name"): own.find("inertial/mass") for own in tree.findall("link")}
    for joint in tree.findall("joint"):
        child = link(joint, "child")
        mass = masses.get(child)
        light = mass is None or float(mass.get("value", "0")) < MASSLESS
        if joint.get("type") == "fixed" and child not in parents and light:
            yield child


def link(joint: ElementTree.Element, end: str) -> str:
    """The name of the link at an end of a joint, `parent` or `child`."""
    element = joint.find(end)
    return "" if element is None else element.get("link", "")
