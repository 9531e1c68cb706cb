"""The tree of joints and links that a URDF describes, read by Pinocchio (the extra `urdf`)."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from scarid_cli.algorithms.keys import values
from scarid_cli.algorithms.robots.files import of_file, text_of
from scarid_cli.algorithms.robots.loops import without_loops
from scarid_cli.algorithms.robots.sound import require_tree, without_impossible
from scarid_cli.errors import UsageFault

ENDLESS = 1e9  # rad: urdfdom does not read inf
ERROR = "Error:"  # that begins what urdfdom prints
FREE = ("floating", "planar")
MASSLESS = 1e-6  # kg: some URDFs give their frames a token mass


@dataclass(frozen=True)
class Tree:
    """A URDF as Pinocchio reads it, and what Pinocchio does not keep of it.

    `model` has all joints that move. `drivers` has the joint that each joint with a <mimic>
    follows, `ratios` how far it moves with it, `offsets` where it is when that joint is at 0 [rad
    or m], `frames` the massless frames at the ends of links: their names, and the numbers of the
    joints that carry them. `doubts` say what of the URDF is not used as it is.
    """

    model: Any
    drivers: dict[str, str]
    ratios: dict[str, float]
    offsets: dict[str, float]
    frames: dict[str, int]
    doubts: tuple[str, ...] = ()


@of_file
def read(path: str, wanted: tuple[str, ...] = ()) -> Tree:
    """The URDF in a file; joints other than the `wanted` ones may be of any type."""
    try:
        import pinocchio
    except ImportError:
        raise UsageFault(
            f"{path}: a URDF needs Pinocchio: pip install 'scarid[urdf]', or '.[urdf]' in a clone"
        ) from None
    text = text_of(path)
    try:
        tree = ElementTree.fromstring(text)
        loops = without_loops(tree, wanted)
        require_tree(tree)
        doubts = [*loops, *without_impossible(tree), *_fixed(tree, wanted)]
        _turn_endless_joints_into_angles(tree)
        _drop_shapes(tree)
        model = _model(pinocchio, ElementTree.tostring(tree, encoding="unicode"))
        values.moderate(model.njoints - 1)
        mimics = {j.get("name", ""): m for j in tree.findall("joint") for m in j.findall("mimic")}
        drivers = {name: mimic.get("joint", "") for name, mimic in mimics.items()}
        ratios = {name: float(mimic.get("multiplier", "1")) for name, mimic in mimics.items()}
        offsets = {name: float(mimic.get("offset", "0")) for name, mimic in mimics.items()}
        tips = list(_massless_tips(tree))
        _require_axes(tree)
    except (RuntimeError, SyntaxError, ValueError) as error:
        raise UsageFault(f"{path}: not a URDF: {' '.join(str(error).split())}") from None
    if not model.nq or model.nq != model.nv:
        free = ", ".join(_free(tree))
        raise UsageFault(
            f"{path}: only revolute, continuous and prismatic joints are supported, and {free} is "
            "neither; name the axes of the arm in a TOML file ([[joint]] name = ...), which fixes "
            "all others of that kind"
        )
    frames = {name: model.frames[model.getFrameId(name)].parentJoint for name in tips}
    return Tree(model, drivers, ratios, offsets, frames, tuple(doubts))


def _free(tree: ElementTree.Element) -> list[str]:
    """The joints that have more than one degree of freedom."""
    return [j.get("name", "") for j in tree.findall("joint") if j.get("type") in FREE]


def _fixed(tree: ElementTree.Element, wanted: tuple[str, ...]) -> list[str]:
    """Fix joints such as a floating base, where others are named as the axes; says which."""
    names = [name for name in _free(tree) if wanted and name not in wanted]
    for joint in tree.findall("joint"):
        if joint.get("name") in names:
            joint.set("type", "fixed")
    return [
        f"joint {name}: taken as fixed, as it is none of the axes that are named" for name in names
    ]


def _model(pinocchio: Any, text: str) -> Any:
    """Pinocchio's model. A value that its parser cannot read is a ValueError with its reason.

    The parser tells that on standard error only, and leaves out what it could not read, such as
    the inertia of a link.
    """
    with _heard() as lines:
        try:
            model, reason = pinocchio.buildModelFromXML(text), None
        except (RuntimeError, ValueError) as error:
            model, reason = None, str(error)
    told = [line.removeprefix(ERROR).strip() for line in lines if line.startswith(ERROR)]
    if told or reason:
        raise ValueError(told[0] if told else reason)
    return model


@contextlib.contextmanager
def _heard() -> Iterator[list[str]]:
    """The lines that libraries print on standard error within the block; known after it."""
    lines: list[str] = []
    own = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            yield lines
        finally:
            os.dup2(own, 2)
            os.close(own)
        file.seek(0)
        lines += file.read().decode(errors="replace").splitlines()


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


def _require_axes(tree: ElementTree.Element) -> None:
    """Refuses an axis without a direction, about which nothing would turn."""
    for joint in tree.findall("joint"):
        axis = joint.find("axis")
        moves = joint.get("type") in ("revolute", "prismatic")
        if moves and axis is not None and not any(map(float, axis.get("xyz", "1").split())):
            raise ValueError(f"the axis of joint {joint.get('name')} is 0 0 0")


def _drop_shapes(tree: ElementTree.Element) -> None:
    """Drops what is not needed here; Pinocchio complains about shapes that it does not know."""
    for material in tree.findall("material"):
        tree.remove(material)
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
