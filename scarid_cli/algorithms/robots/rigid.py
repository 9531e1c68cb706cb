"""The rigid-body part of a regressor from a URDF, through Pinocchio (the extra `urdf`).

Columns are those of the ten standard parameters of each link, in the order of SYMBOLS: moments of
inertia about the link's frame [kg m2], first moments [kg m], mass [kg].
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import inf
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault

SYMBOLS = ("Ixx", "Ixy", "Ixz", "Iyy", "Iyz", "Izz", "mx", "my", "mz", "m")
UNITS = ("kg m2",) * 6 + ("kg m",) * 3 + ("kg",)
PINOCCHIO = np.array([4, 5, 7, 6, 8, 9, 1, 2, 3, 0])  # where it keeps them


ENDLESS = 1e9  # rad: urdfdom does not read inf
GRAVITY = (0.0, 0.0, -9.81)  # m/s2


@cache
def _model(path: str, gravity: tuple[float, ...], joints: tuple[str, ...]) -> Any:
    """Pinocchio's model: of all joints that move, or of some, the others locked at 0."""
    try:
        import pinocchio
    except ImportError:
        raise UsageFault(f"{path}: a URDF needs Pinocchio: pip install 'scarid[urdf]'") from None
    if not Path(path).exists():
        raise UsageFault(f"{path}: no such file")
    try:
        model = pinocchio.buildModelFromXML(_with_limits(Path(path).read_text("utf-8")))
    except (RuntimeError, SyntaxError, ValueError) as error:
        raise UsageFault(f"{path}: not a URDF: {' '.join(str(error).split())}") from None
    if not model.nq or model.nq != model.nv:
        raise UsageFault(f"{path}: only revolute, continuous and prismatic joints are understood")
    if joints:
        names = list(model.names)[1:]
        kept = [name for name in names if name in joints]
        if kept != list(joints):
            raise UsageFault(
                f"{path}: no joints {', '.join(joints)} in this order; it has {', '.join(names)}"
            )
        locked = [i for i, name in enumerate(names, start=1) if name not in joints]
        model = pinocchio.buildReducedModel(model, locked, pinocchio.neutral(model))
    model.gravity.linear = np.array(gravity)
    return model


def _with_limits(text: str) -> str:
    """Joints without end are revolute ones: their position is an angle, not a point of a circle."""
    tree = ElementTree.fromstring(text)
    for joint in tree.iter("joint"):
        if joint.get("type") == "continuous":
            joint.set("type", "revolute")
            limit = joint.find("limit")
            limit = ElementTree.SubElement(joint, "limit") if limit is None else limit
            for key, value in (("lower", -ENDLESS), ("upper", ENDLESS)):
                limit.set(key, str(value))
            for key in ("effort", "velocity"):
                limit.set(key, limit.get(key, "0"))
    return ElementTree.tostring(tree, encoding="unicode")


def _limit(value: float) -> float:
    """0 is a limit that was not given."""
    return float(value) if 0.0 < value < ENDLESS else inf


@dataclass(frozen=True)
class Body:
    """A serial arm as a URDF describes it: all joints that move, or those of some names."""

    path: str
    gravity: tuple[float, ...] = GRAVITY
    joints: tuple[str, ...] = ()

    @property
    def model(self) -> Any:
        """Pinocchio's."""
        return _model(self.path, self.gravity, self.joints)

    @property
    def joints_found(self) -> list[Joint]:
        """With the limits that the URDF has."""
        model = self.model
        names = [joint.shortname() for joint in list(model.joints)[1:]]
        reach = np.maximum(np.abs(model.lowerPositionLimit), np.abs(model.upperPositionLimit))
        limits = zip(names, reach, model.velocityLimit, model.effortLimit, strict=True)
        return [
            Joint(
                type="prismatic" if "JointModelP" in name else "revolute",
                position_limit=_limit(position),
                velocity_limit=_limit(velocity),
                torque_limit=_limit(torque),
            )
            for name, position, velocity, torque in limits
        ]

    @property
    def standard(self) -> list[float]:
        """The URDF's own values of the standard parameters, joint after joint."""
        inertias = list(self.model.inertias)[1:]
        return [float(x) for own in inertias for x in own.toDynamicParameters()[PINOCCHIO]]

    @property
    def joint_names(self) -> list[str]:
        """Of the URDF."""
        return list(self.model.names)[1:]

    @property
    def links(self) -> list[tuple[str, list[str]]]:
        """The link that each joint moves, and those fixed to it."""
        tree = ElementTree.parse(self.path).getroot()
        child = {j.get("name"): j.find("child") for j in tree.findall("joint")}
        together: dict[int, list[str]] = {i: [] for i in range(1, self.model.njoints)}
        for frame in self.model.frames:
            if str(frame.type) == "BODY" and frame.parentJoint:
                together[frame.parentJoint].append(frame.name)
        found = []
        for i, name in enumerate(self.joint_names, start=1):
            element = child[name]
            own = str(element.get("link")) if element is not None else together[i][0]
            found.append((own, [link for link in together[i] if link != own]))
        return found

    def columns(self, q: Array, dq: Array, ddq: Array) -> Array:
        """The regressor of the standard parameters (samples, joints, 10 joints)."""
        import pinocchio

        model = self.model
        data = model.createData()
        joints, samples = q.shape
        W = np.empty((samples, joints, 10 * joints))
        order = (10 * np.arange(joints)[:, None] + PINOCCHIO).ravel()
        for k in range(samples):
            Y = pinocchio.computeJointTorqueRegressor(model, data, q[:, k], dq[:, k], ddq[:, k])
            W[k] = Y.reshape(joints, -1)[:, order]
        return W
