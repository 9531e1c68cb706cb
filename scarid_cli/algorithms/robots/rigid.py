"""The rigid bodies of a robot with a URDF, which Pinocchio reads (the extra `urdf`).

Each link has ten standard parameters, in the order of SYMBOLS: moments and products of inertia in
the frame of the link [kg m2], first moments [kg m], mass [kg].
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any
from xml.etree import ElementTree

import numpy as np

from scarid_cli.algorithms.robots import newton_euler
from scarid_cli.algorithms.robots.axes import LOST, Chain, named, serial
from scarid_cli.algorithms.robots.capsules import Capsule, capsules_of
from scarid_cli.algorithms.robots.files import of_file
from scarid_cli.algorithms.robots.following import Following
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.robots.pose import Points, Pose
from scarid_cli.algorithms.robots.tree import ENDLESS, link, read
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

SYMBOLS = ("Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz", "mx", "my", "mz", "m")
STANDARD_UNITS = ("kg m2",) * 6 + ("kg m",) * 3 + ("kg",)
PINOCCHIO = np.array([4, 5, 7, 6, 8, 9, 1, 2, 3, 0])  # their places there

Posture = tuple[tuple[str, float], ...]  # joints that are no axes, and their positions [rad or m]
GRAVITY = (0.0, 0.0, -9.81)  # m/s2


@of_file
def _chain(path: str, wanted: tuple[str, ...]) -> Chain:
    """The axes: the joints of some names, or else those of the serial arm."""
    tree = read(path, wanted)
    names = list(tree.model.names)[1:]
    if wanted:
        if [name for name in names if name in wanted] != list(wanted):
            raise UsageFault(
                f"{path}: no joints {', '.join(wanted)} in this order; it has {', '.join(names)}"
            )
        return named(names, list(tree.model.parents)[1:], tree.drivers, wanted)
    chain = serial(names, list(tree.model.parents)[1:], tree.drivers, set(tree.frames.values()))
    if not chain.axes:
        raise UsageFault(
            f"{path}: the moving joints branch at the base, so that it is not clear which are the "
            f"arm's; name them in a description ([[joint]] name = ...): {', '.join(names)}"
        )
    return chain


@of_file
def _model(path: str, gravity: tuple[float, ...], wanted: tuple[str, ...], posture: Posture) -> Any:
    """Pinocchio's model of the axes and of the joints that follow them.

    Other joints are locked where the posture has them, else at 0, or at the offset of a mimic.
    """
    tree = read(path, wanted)
    import pinocchio  # after it has been found there

    place = pinocchio.neutral(tree.model)
    locked = []
    for name in _chain(path, wanted).locked:
        number = tree.model.getJointId(name)
        at = dict(posture).get(name, tree.offsets.get(name, 0.0))
        place[tree.model.joints[number].idx_q] = at
        locked.append(number)
    model = pinocchio.buildReducedModel(tree.model, locked, place) if locked else tree.model.copy()
    model.gravity.linear = np.array(gravity)
    return model


def _limit(value: float) -> float:
    """A limit of the URDF; 0 stands for one that was not given."""
    return float(value) if 0.0 < value < ENDLESS else inf


def _interval(lower: float, upper: float) -> tuple[float, float]:
    """Position limits of the URDF; both are 0 where they were not given."""
    if lower == upper == 0.0:
        return -inf, inf
    return (float(lower) if lower > -ENDLESS else -inf, float(upper) if upper < ENDLESS else inf)


@dataclass(frozen=True)
class Frame:
    """A link as it is fixed to an axis (from 1; 0 is the base).

    `turn` (3, 3) and `origin` (3) [m] are in the frame of the axis.
    """

    axis: int
    turn: Array
    origin: Array

    def carried(self, place: Sequence[float]) -> Array:
        """A place in the frame of the link (3), in the frame of the axis [m]."""
        return np.asarray(self.origin + self.turn @ np.array(place))


@dataclass(frozen=True)
class Held:
    """A link behind a joint that is no axis, such as a finger, where this joint is held.

    It is part of the body of the `axis` (from 1). Its standard parameters (10), and those of the
    links that are fixed to it, are `own` in its frame, and `carried` in that of the axis.
    """

    axis: int
    link: str
    own: Array
    carried: Array


@dataclass(frozen=True)
class Body:
    """A serial arm as a URDF describes it.

    `joints` names its axes, or leaves them to axes.py; `added` are capsules of its links beside
    those of the URDF; `posture` says where joints are that are no axes [rad or m].
    """

    path: str
    gravity: tuple[float, ...] = GRAVITY
    joints: tuple[str, ...] = ()
    added: tuple[Capsule, ...] = ()
    posture: Posture = ()

    @property
    def model(self) -> Any:
        """The model of Pinocchio."""
        return _model(self.path, self.gravity, self.joints, self.posture)

    @property
    def joints_found(self) -> list[Joint]:
        """The axes, with the limits that the URDF gives for them and for what follows them."""
        model = self.model
        names = [joint.shortname() for joint in list(model.joints)[1:]]
        ends = map(_interval, model.lowerPositionLimit, model.upperPositionLimit)
        limits = zip(names, ends, model.velocityLimit, model.effortLimit, strict=True)
        joints = [
            Joint(
                "prismatic" if "JointModelP" in name else "revolute",
                *interval,
                velocity_limit=_limit(velocity),
                torque_limit=_limit(torque),
            )
            for name, interval, velocity, torque in limits
        ]
        return self.following.limited(joints)

    @cached_property
    def axes(self) -> Array:
        """The geometry of the axes (joints, 16), as mechanism.Mechanism describes it."""
        model = self.model
        rows = []
        for joint, placement in zip(
            list(model.joints)[1:], list(model.jointPlacements)[1:], strict=True
        ):
            data = joint.createData()
            joint.calc(data, np.zeros(1), np.zeros(1))
            along, about = np.split(np.ravel(data.S), 2)
            prismatic = bool(np.any(along))
            direction = along if prismatic else about
            rows.append(
                [*placement.rotation.ravel(), *placement.translation, *direction, prismatic]
            )
        return np.array(rows, dtype=np.float64)

    @property
    def standard(self) -> list[float]:
        """The standard parameters that the URDF gives, link after link."""
        inertias = list(self.model.inertias)[1:]
        return [float(x) for own in inertias for x in own.toDynamicParameters()[PINOCCHIO]]

    @property
    def locked(self) -> dict[str, str]:
        """The moving joints that are not axes, and why each is locked."""
        return _chain(self.path, self.joints).locked

    @property
    def doubts(self) -> list[str]:
        """What of the URDF is not used as it is: impossible inertias, joints that follow."""
        follows = [f"joint {name}: {why}" for name, why in self.locked.items() if LOST in why]
        return [*read(self.path, self.joints).doubts, *follows]

    @property
    def moving(self) -> list[str]:
        """The names of the axes and of the joints that follow them, from the base to the tip."""
        return list(self.model.names)[1:]

    @property
    def joint_names(self) -> list[str]:
        """The names of the axes in the URDF."""
        return list(_chain(self.path, self.joints).axes)

    @property
    def link_numbers(self) -> list[int]:
        """The number of each link from the base to the tip: that of its axis.

        Those that joints carry which follow an axis have the numbers after the last axis.
        """
        after = iter(range(len(self.joint_names) + 1, len(self.moving) + 1))
        numbers = {name: i for i, name in enumerate(self.joint_names, start=1)}
        return [numbers[name] if name in numbers else next(after) for name in self.moving]

    @cached_property
    def following(self) -> Following:
        """How the joints of the chain move with its axes."""
        tree, followers = read(self.path, self.joints), _chain(self.path, self.joints).followers
        axis, ratio, offset = [], [], []
        for name in self.moving:
            driver, turns, at = name, 1.0, 0.0
            while driver in followers and driver not in self.joint_names:
                at += turns * tree.offsets[driver]
                turns *= tree.ratios[driver]
                driver = tree.drivers[driver]
            axis.append(self.joint_names.index(driver))
            ratio.append(turns)
            offset.append(at)
        own = np.array([self.moving.index(name) for name in self.joint_names], dtype=np.int64)
        return Following(np.array(axis, dtype=np.int64), np.array(ratio), np.array(offset), own)

    @property
    def followers(self) -> list[str]:
        """How each joint moves that follows an axis."""
        follows, told = self.following, []
        for k in follows.followers:
            axis, offset = self.joint_names[follows.axis[k]], follows.offset[k]
            beside = f" {offset:+g}" if offset else ""
            told.append(f"{self.moving[k]} = {follows.ratio[k]:g} {axis}{beside}")
        return told

    def pose(self, q: Array) -> Pose:
        """Where the links are; q is (axes, samples) [rad or m]."""
        return Pose.of(self.axes, self.following.positions(q))

    @property
    def links(self) -> list[tuple[str, list[str]]]:
        """The link that each axis moves, and the links that are fixed to it."""
        child = self._children
        together: dict[int, list[str]] = {i: [] for i in range(1, self.model.njoints)}
        for frame in self.model.frames:
            if str(frame.type) == "BODY" and frame.parentJoint:
                together[frame.parentJoint].append(frame.name)
        found = []
        for i, name in enumerate(self.moving, start=1):
            own = child[name]
            found.append((own, [link for link in together[i] if link != own]))
        return found

    @property
    def _children(self) -> dict[str | None, str]:
        """The link that each joint of the URDF carries."""
        tree = ElementTree.parse(self.path).getroot()
        return {j.get("name"): link(j, "child") for j in tree.findall("joint")}

    @cached_property
    def held(self) -> list[Held]:
        """The links with a mass behind joints that are no axes."""
        import pinocchio  # after it has been found by `read`

        model, found, child = read(self.path, self.joints).model, [], self._children
        for name in _chain(self.path, self.joints).locked:
            own, frame = model.inertias[model.getJointId(name)], self.frames[child[name]]
            if frame.axis and own.mass > 0.0:
                carried = pinocchio.SE3(frame.turn, frame.origin).act(own)
                both = (x.toDynamicParameters()[PINOCCHIO] for x in (own, carried))
                found.append(Held(frame.axis, child[name], *both))
        return found

    @cached_property
    def frames(self) -> dict[str, Frame]:
        """Where each link is."""
        return {
            frame.name: Frame(
                frame.parentJoint,
                frame.placement.rotation.copy(),
                frame.placement.translation.copy(),
            )
            for frame in self.model.frames
            if str(frame.type) == "BODY"
        }

    @property
    def tool(self) -> str:
        """The link that is the tool frame: the last one that is fixed to the last axis.

        Massless frames come before links with a mass.
        """
        tree = read(self.path, self.joints)
        last = tree.model.getJointId(self.moving[-1])
        tips = [name for name, number in tree.frames.items() if number == last]
        fixed = [
            f.name for f in tree.model.frames if f.parentJoint == last and f.name in self.frames
        ]
        return (tips or fixed)[-1]

    @property
    def capsules(self) -> list[Capsule]:
        """The capsules of the links, those of the URDF first."""
        return [*capsules_of(self.path), *self.added]

    def points(self, link: str, places: Sequence[Sequence[float]] = ((0.0, 0.0, 0.0),)) -> Points:
        """Points in the frame of a link [m], by default its origin."""
        frame = self.frames[link]
        numbers = np.full(len(places), frame.axis)
        return Points(numbers, np.array([frame.carried(place) for place in places]))

    def columns(self, q: Array, dq: Array, ddq: Array) -> Array:
        """The regressor of the standard parameters (samples, axes, 10 links).

        q, dq and ddq are (axes, samples), in rad or m, and per s and s2.
        """
        follows = self.following
        motion = follows.positions(q), follows.rates(dq), follows.rates(ddq)
        W = newton_euler.regressor(self.axes, np.array(self.gravity), *motion)
        return follows.torques(W.swapaxes(0, 1)).swapaxes(0, 1)

    def torques(self, motion: Array, places: Sequence[int], values: Array) -> Array:
        """The columns in these places times values: torques (axes, samples) [N m or N].

        motion (3, axes, samples): q, dq and ddq, in rad or m, and per s and s2.
        """
        follows, (q, dq, ddq) = self.following, motion
        moved = follows.positions(q), follows.rates(dq), follows.rates(ddq)
        links = np.zeros(newton_euler.LINK * len(self.axes))
        links[list(places)] = values
        tau = newton_euler.torques(self.axes, np.array(self.gravity), *moved, links)
        return follows.torques(tau)
