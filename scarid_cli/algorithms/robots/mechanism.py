"""A robot as a chain of rigid links, in the layout that the compiled kernels take.

A robot with a URDF has the axes and links of its URDF. One without has a chain that gives the same
torques: the planar arm has two parallel axes, and an axis that moves alone carries no link.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.following import Following
from scarid_cli.algorithms.robots.planar import L1MX2, L1MY2, MX1R, MX2, ZZ1R, ZZ2, PlanarTerm
from scarid_cli.algorithms.robots.terms import StandardTerm, Term
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

STANDARD = 10  # parameters of a link, in the order of rigid.SYMBOLS
# The standard parameters that the terms of a planar arm multiply.
PLANAR: dict[type[Term], int] = {ZZ1R: 5, MX1R: 6, ZZ2: 15, L1MX2: 16, MX2: 16, L1MY2: 17}


@dataclass(frozen=True)
class Mechanism:
    """The joints and links of a serial chain.

    A row of `axes` (joints, 16) has the rotation from the frame of the axis to the frame of the
    axis before it, at q = 0, row by row [9]; the origin of the frame there [3, m]; the direction of
    the axis in its own frame [3]; and 1 for a prismatic axis, 0 for a revolute one. `links`
    (joints, 10) has the standard parameters of each link in the frame of its axis, in the order of
    rigid.SYMBOLS. `gravity` (3) is in the frame of the base [m/s2]. `following` says which joints
    move with others.
    """

    axes: Array
    links: Array
    gravity: Array
    following: Following


def mechanism(robot: Robot) -> Mechanism:
    """The chain of a robot, its links with the robot's own a priori values.

    Base parameters stand for the standard parameters of the same names; the others are zero, which
    gives the same torques.
    """
    joints = len(robot.joints)
    following = robot.body.following if robot.body else Following.none(joints)
    links = np.zeros((len(following.axis), STANDARD))
    for place, parameter in zip(places(robot), robot.parameters, strict=True):
        if place is not None:
            links.flat[place] += parameter.apriori
    if robot.body:
        return Mechanism(robot.body.axes, links, np.array(robot.body.gravity), following)
    axes = np.zeros((joints, 16))
    axes[:, [0, 4, 8, 14]] = 1.0
    axes[:, 15] = [joint.type == "prismatic" for joint in robot.joints]
    planar = {p.term.NAME: p.term for p in robot.parameters if isinstance(p.term, PlanarTerm)}
    length, gravity = _planar(robot.name, planar)
    if planar:
        axes[1, 9] = length
    return Mechanism(axes, links, np.array([gravity, 0.0, 0.0]), following)


def places(robot: Robot) -> list[int | None]:
    """The standard parameter that each parameter stands for, as an index of all links' parameters.

    None stands for friction and motors, which are no part of the chain.
    """
    terms = [parameter.term for parameter in robot.parameters]
    return [t.place if isinstance(t, StandardTerm) else PLANAR.get(type(t)) for t in terms]


def _planar(name: str, terms: dict[str, PlanarTerm]) -> tuple[float, float]:
    """The length of link 1 [m] and the gravity along it at q = 0 [m/s2] of a planar arm.

    L1MX2 and L1MY2 are products with the length, which is then taken as 1 m.
    """
    products = {L1MX2.NAME, L1MY2.NAME} & set(terms)
    constants = [term for term in terms.values() if isinstance(term, MX1R | MX2)]
    lengths = {term.length for term in constants if isinstance(term, MX2)}
    gravities = {term.gravity for term in constants}
    if products:
        lengths.add(1.0)
        gravities.add(0.0)
    if len(lengths) > 1 or len(gravities) > 1:
        raise UsageFault(
            f"robot {name}: its terms {', '.join(terms)} are not those of one arm; give the same "
            "gravity and length everywhere"
        )
    return next(iter(lengths), 0.0), next(iter(gravities), 0.0)
