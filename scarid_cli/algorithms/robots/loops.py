"""Closed chains of a URDF, which is a tree: what closes them is left out, and told."""

from __future__ import annotations

from xml.etree import ElementTree

from scarid_cli.algorithms.robots.sound import end_of

LOOP = "loop_joint"  # an element of some simulators, which names the two links that it connects
UNSEEN = "what it passes on is not modelled"


def without_loops(robot: ElementTree.Element, wanted: tuple[str, ...] = ()) -> list[str]:
    """Take out the joints beyond the first that carry a link, and say which.

    The first one is an axis that is `wanted`, else the first in the file to which a way leads from
    the base. What a joint that is taken out passes on is not modelled.
    """
    told = [
        f"{LOOP} {loop.get('name')}: left out: it closes a chain, and {UNSEEN}"
        for loop in robot.findall(LOOP)
    ]
    carriers: dict[str, list[ElementTree.Element]] = {}
    for joint in robot.findall("joint"):
        carriers.setdefault(end_of(joint, "child"), []).append(joint)
    for link, joints in carriers.items():
        if len(joints) > 1:
            kept = _kept(joints, carriers, wanted)
            for joint in joints:
                if joint is not kept:
                    robot.remove(joint)
                    told.append(
                        f"joint {joint.get('name')}: left out, as joint {kept.get('name')} carries "
                        f"link {link} as well: it closes a chain, and {UNSEEN}"
                    )
            carriers[link] = [kept]
    return told


def _kept(
    joints: list[ElementTree.Element],
    carriers: dict[str, list[ElementTree.Element]],
    wanted: tuple[str, ...],
) -> ElementTree.Element:
    axes = [joint for joint in joints if joint.get("name") in wanted]
    reached = [joint for joint in joints if not _below(joint, carriers)]
    return [*axes, *reached, *joints][0]


def _below(joint: ElementTree.Element, carriers: dict[str, list[ElementTree.Element]]) -> bool:
    """Whether the way up from the parent of a joint leads to the link that it carries."""
    target, link, seen = end_of(joint, "child"), end_of(joint, "parent"), set[str]()
    while link in carriers and link not in seen:
        if link == target:
            return True
        seen.add(link)
        link = end_of(carriers[link][0], "parent")
    return link in seen
