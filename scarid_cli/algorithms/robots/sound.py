"""Whether a URDF is one tree of sound numbers, before its parser sees it.

urdfdom leaves out, without a word, joints that no way leads to from the root. It follows a chain by
recursion, and overflows its stack on a long one.
"""

from __future__ import annotations

from math import isfinite
from xml.etree import ElementTree

import numpy as np

JOINTS = 1000  # of a chain or of a whole robot, fixed ones included
FURTHEST = 1e6  # m or rad, of an origin
ROUNDED = 0.01  # of an inertia, as files with few digits have it
NOTHING = 1e-12  # kg m2, of a milligram at a millimetre: what CAD leaves of the inertia of a point
ATTRIBUTES = 64  # of an element: URDF has at most six


def require_tree(robot: ElementTree.Element) -> None:
    """Refuse cycles, islands and numbers of no robot; ValueError. See also loops.py."""
    for element in robot.iter():
        if len(element.attrib) > ATTRIBUTES:
            raise ValueError(f"<{element.tag}> has {len(element.attrib)} attributes")
    joints = robot.findall("joint")
    if len(joints) > JOINTS:
        raise ValueError(f"it has {len(joints)} joints, more than {JOINTS}")
    for joint in joints:
        _require_near(joint, joint)
    for link in robot.findall("link"):
        for inertial in link.findall("inertial"):
            _require_near(link, inertial)
    _require_connected(robot, joints)


def without_impossible(robot: ElementTree.Element) -> list[str]:
    """Take out masses and inertias below 0, with which sums may be of any size; say of which links.

    Inertias that only break the triangle inequality stay as they are, and are told as well.
    """
    told = [
        (link.get("name"), _mended(link, inertial))
        for link in robot.findall("link")
        for inertial in link.findall("inertial")
    ]
    return [f"link {name}: {text}" for name, text in told if text]


def _mended(link: ElementTree.Element, inertial: ElementTree.Element) -> str:
    """What is impossible in the inertia of a link, and what it is taken as; empty if nothing is."""
    mass, inertia = inertial.find("mass"), inertial.find("inertia")
    if mass is not None and _number(mass, "value") < 0.0:
        link.remove(inertial)
        return f"its mass is {mass.get('value')} kg; taken as without mass"
    if inertia is None:
        return ""
    x, y, z, xy, xz, yz = (_number(inertia, f"i{a}") for a in ("xx", "yy", "zz", "xy", "xz", "yz"))
    moments = np.linalg.eigvalsh([[x, xy, xz], [xy, y, yz], [xz, yz, z]])
    told = f"its principal inertias are {', '.join(f'{moment:.3g}' for moment in moments)} kg m2"
    nothing = np.abs(moments).max() < NOTHING
    if moments[0] < -ROUNDED * abs(moments[-1]):
        for key in inertia.attrib:
            inertia.set(key, "0")
        return "" if nothing else f"{told}, negative; taken as a point"
    if not nothing and moments[-1] > (1.0 + ROUNDED) * (moments[0] + moments[1]):
        return f"{told}, of which one is larger than the sum of the others"
    return ""


def _number(element: ElementTree.Element, key: str) -> float:
    """A number; 0 for what the reader of URDFs will not take for one either."""
    try:
        value = float(element.get(key, "0"))
    except ValueError:
        return 0.0
    return value if isfinite(value) else 0.0


def _require_near(named: ElementTree.Element, placed: ElementTree.Element) -> None:
    """Refuse an origin that is infinite or out of this world."""
    for origin in placed.findall("origin"):
        for key in ("xyz", "rpy"):
            numbers = [float(x) for x in origin.get(key, "").split()]
            if any(not isfinite(x) or abs(x) > FURTHEST for x in numbers):
                place = f"{named.tag} {named.get('name')}"
                raise ValueError(f"the origin of {place} has {key} {origin.get(key)}")


def _require_connected(robot: ElementTree.Element, joints: list[ElementTree.Element]) -> None:
    ends = [
        (joint.get("name"), end_of(joint, "parent"), end_of(joint, "child")) for joint in joints
    ]
    links = [link.get("name", "") for link in robot.findall("link")]
    if any(end not in links for _, *both in ends for end in both):
        return  # the reader of URDFs names the link that there is not
    carried = {child for _, _, child in ends}
    roots = [name for name in links if name not in carried]
    if links and len(roots) != 1 and ends:
        found = ", ".join(roots) or "none"
        raise ValueError(f"it needs one link that no joint carries, its base; it has {found}")
    children: dict[str, list[str]] = {}
    for _, parent, child in ends:
        children.setdefault(parent, []).append(child)
    reached, waiting = set(roots), list(roots)
    while waiting:
        for child in children.get(waiting.pop(), []):
            reached.add(child)
            waiting.append(child)
    lost = [name for name, _, child in ends if child not in reached]
    if lost:
        names = ", ".join(map(str, lost))
        raise ValueError(f"no way leads from the base {roots[0]} to joint {names}")


def end_of(joint: ElementTree.Element, tag: str) -> str:
    """The link that is the parent, or the child, of a joint."""
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")
