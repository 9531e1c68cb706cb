"""Whether a URDF is one tree of sound numbers, before its parser sees it.

urdfdom leaves out, without a word, joints that no way leads to from the root. It follows a chain by
recursion, and overflows its stack on a long one.
"""

from __future__ import annotations

from collections import Counter
from math import isfinite
from xml.etree import ElementTree

JOINTS = 1000  # of a chain or of a whole robot, fixed ones included
FURTHEST = 1e6  # m or rad, of an origin
ATTRIBUTES = 64  # of an element: URDF has at most six


def require_tree(robot: ElementTree.Element) -> None:
    """Refuse cycles, islands, links with two parents, and numbers of no robot; ValueError."""
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


def _require_near(named: ElementTree.Element, placed: ElementTree.Element) -> None:
    """Refuse an origin that is infinite or out of this world."""
    for origin in placed.findall("origin"):
        for key in ("xyz", "rpy"):
            numbers = [float(x) for x in origin.get(key, "").split()]
            if any(not isfinite(x) or abs(x) > FURTHEST for x in numbers):
                place = f"{named.tag} {named.get('name')}"
                raise ValueError(f"the origin of {place} has {key} {origin.get(key)}")


def _require_connected(robot: ElementTree.Element, joints: list[ElementTree.Element]) -> None:
    ends = [(joint.get("name"), _end(joint, "parent"), _end(joint, "child")) for joint in joints]
    twice = [child for child, n in Counter(child for _, _, child in ends).items() if n > 1]
    if twice:
        raise ValueError(f"link {twice[0]} has two parents")
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


def _end(joint: ElementTree.Element, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else element.get("link", "")
