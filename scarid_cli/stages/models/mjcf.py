"""An identified arm for MuJoCo, which reads its URDF (the extra `sim`).

MuJoCo makes the tree of bodies and their shapes. Its own XML has six digits, so the numbers that
torques depend on are written again with all of theirs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from xml.etree import ElementTree

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.drives import Drives, drives
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.robots.physical import Physical, inertia_of
from scarid_cli.algorithms.robots.sound import without_impossible
from scarid_cli.algorithms.robots.tree import FREE, read
from scarid_cli.errors import UsageFault
from scarid_cli.io.urdf import Inertial
from scarid_cli.stages.models.intervals import Interval

Element = ElementTree.Element
SETTINGS = {"fusestatic": "false", "discardvisual": "false", "balanceinertia": "false"}


def mjcf(
    urdf: str, robot: Robot, found: Physical, remark: str, rows: Sequence[Interval]
) -> tuple[str, list[str]]:
    """The MJCF of the arm with the bodies that were found, and remarks on what it lacks."""
    mujoco = _mujoco()
    assert robot.body
    own = drives(robot, found.axes)
    prepared, meshes = _prepared(urdf)
    try:
        spec = mujoco.MjSpec.from_string(prepared)
        _lock(mujoco, spec, robot)
        spec.compile()
        root = ElementTree.fromstring(spec.to_xml())
        _place(root, spec)
        _weigh(root, robot, found)
        _drive(root, robot, own)
        _couple(root, own)
        _follow(root, robot)
        _settle(root, robot)
        _note(root, found, remark, rows)
        ElementTree.indent(root)
        text = ElementTree.tostring(root, encoding="unicode") + "\n"
        mujoco.MjModel.from_xml_string(text)
    except (ValueError, mujoco.FatalError) as error:
        raise UsageFault(
            f"{robot.body.path}: MuJoCo says: {' '.join(str(error).split())}"
        ) from None
    return text, list(_remarks(meshes, own))


def _mujoco() -> Any:
    try:
        import mujoco
    except ImportError:
        raise UsageFault("--to mjcf needs MuJoCo: pip install 'scarid[sim,urdf]'") from None
    return mujoco


def _remarks(meshes: int, own: Drives) -> Iterator[str]:
    if meshes:
        yield f"{meshes} shapes that are meshes are left out; they change no torque"
    if lost := {name: x for name, x in own.rest.items() if x}:
        told = ", ".join(f"{name} {x:.4g}" for name, x in lost.items())
        yield f"warning: MuJoCo has nothing like these, which are left out: {told}"
    for c in own.couplings:
        if c.coulomb < 0.0:
            yield f"fsm{c.two + 1} {c.coulomb:.4g} is left out: MuJoCo has no negative friction"


def _prepared(urdf: str) -> tuple[str, int]:
    """The URDF as MuJoCo shall read it, and the number of its meshes, which are left out."""
    tree = ElementTree.fromstring(urdf)
    without_impossible(tree)
    meshes = 0
    for link in tree.iter("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            if shape.find("geometry/mesh") is not None:
                link.remove(shape)
                meshes += 1
    for material in tree.iter("material"):
        for texture in material.findall("texture"):
            material.remove(texture)
    for joint in tree.findall("joint"):
        if joint.get("type") in FREE:  # of those, none is an axis
            joint.set("type", "fixed")
        for mimic in joint.findall("mimic"):
            joint.remove(mimic)
    for old in tree.findall("mujoco"):
        tree.remove(old)
    ElementTree.SubElement(ElementTree.SubElement(tree, "mujoco"), "compiler", SETTINGS)
    return ElementTree.tostring(tree, encoding="unicode"), meshes


def _lock(mujoco: Any, spec: Any, robot: Robot) -> None:
    """Fix the joints that are no axes and follow none, where the description has them."""
    assert robot.body
    offsets = read(robot.body.path, robot.body.joints).offsets
    for joint in list(spec.joints):
        if joint.name not in robot.body.locked:
            continue
        at = dict(robot.body.posture).get(joint.name, offsets.get(joint.name, 0.0))
        body, turn = joint.parent, np.zeros(4)
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
            mujoco.mju_axisAngle2Quat(turn, joint.axis, at)
            quat = body.quat.copy()
            mujoco.mju_mulQuat(body.quat, quat, turn)
        else:
            along = np.zeros(3)
            mujoco.mju_rotVecQuat(along, at * joint.axis, body.quat)
            body.pos = body.pos + along
        spec.delete(joint)


def _place(root: Element, spec: Any) -> None:
    """Write the frames of the bodies with all digits."""
    for body in root.iter("body"):
        own = spec.body(body.get("name"))
        body.attrib.update(pos=_row(own.pos), quat=_row(own.quat / np.linalg.norm(own.quat)))


def _weigh(root: Element, robot: Robot, found: Physical) -> None:
    """Write the bodies that were found; links fixed to one are a part of it."""
    assert robot.body
    bodies = {body.get("name"): body for body in root.iter("body")}
    for row, (name, fixed) in zip(found.bodies, robot.body.links, strict=True):
        for body in (bodies[x] for x in (name, *fixed) if x in bodies):
            for old in body.findall("inertial"):
                body.remove(old)
        own = Inertial.of(row[9], row[6:9], inertia_of(row))
        full = own.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        numbers = {"pos": _row(own.centre), "mass": _row([own.mass]), "fullinertia": _row(full)}
        bodies[name].insert(0, Element("inertial", numbers))


def _drive(root: Element, robot: Robot, own: Drives) -> None:
    """Write the joints, and the motors that move them."""
    joints = {joint.get("name"): joint for joint in root.iter("joint")}
    actuators = ElementTree.SubElement(root, "actuator")
    biases = -np.linalg.solve(own.ratios.T, [axis.constant for axis in own.axes])
    for i, axis in enumerate(own.axes):
        inertia, viscous = own.uncoupled[i]
        terms = {"armature": inertia, "damping": viscous, "frictionloss": axis.coulomb}
        joints[axis.joint].attrib.update(_limits(robot.joints[i]))
        joints[axis.joint].attrib.update({key: _row([x]) for key, x in terms.items()})
        motor = {"name": axis.joint, "gainprm": "1"}
        if biases[i]:
            motor |= {"biastype": "affine", "biasprm": _row([biases[i], 0.0, 0.0])}
        turned = np.flatnonzero(own.ratios[i])
        if len(turned) == 1:
            motor |= {"joint": axis.joint, "gear": _row([own.ratios[i, i]])}
        else:
            motor |= {"tendon": f"motor of {axis.joint}"}
            turns = {own.axes[k].joint: own.ratios[i, k] for k in turned}
            _tendon(root, {"name": motor["tendon"]}, turns)
        ElementTree.SubElement(actuators, "general", motor)


def _couple(root: Element, own: Drives) -> None:
    """Write the motors that turn with two axes, as tendons with inertia and friction."""
    for c in own.couplings:
        one, two = own.axes[c.one].joint, own.axes[c.two].joint
        numbers = {
            "name": f"coupling of {one} and {two}",
            "armature": _row([c.inertia]),
            "damping": _row([c.viscous]),
            "frictionloss": _row([max(c.coulomb, 0.0)]),
        }
        _tendon(root, numbers, {one: c.ratio, two: 1.0})


def _tendon(root: Element, numbers: dict[str, str], turns: Mapping[str, float]) -> None:
    """Write a tendon whose length is the sum of these `turns` of joints."""
    tendons = root.find("tendon")
    tendons = ElementTree.SubElement(root, "tendon") if tendons is None else tendons
    fixed = ElementTree.SubElement(tendons, "fixed", numbers)
    for joint, ratio in turns.items():
        ElementTree.SubElement(fixed, "joint", {"joint": joint, "coef": _row([ratio])})


def _limits(joint: Joint) -> Mapping[str, str]:
    """The limits of the description, where there are any."""
    found = {}
    if np.isfinite([joint.lower, joint.upper]).all():
        found["range"] = _row([joint.lower, joint.upper])
    if np.isfinite(joint.torque_limit):
        found["actuatorfrcrange"] = _row([-joint.torque_limit, joint.torque_limit])
    return found


def _follow(root: Element, robot: Robot) -> None:
    """Tie the joints that follow an axis to it."""
    assert robot.body
    follows, moving = robot.body.following, robot.body.moving
    if not follows.followers:
        return
    ties = ElementTree.SubElement(root, "equality")
    for k in follows.followers:
        line = _row([follows.offset[k], follows.ratio[k], 0.0, 0.0, 0.0])
        pair = {"joint1": moving[k], "joint2": robot.body.joint_names[follows.axis[k]]}
        ElementTree.SubElement(ties, "joint", {**pair, "polycoef": line})


def _settle(root: Element, robot: Robot) -> None:
    """Gravity; masses from the bodies alone; shapes that touch others, but not each other."""
    assert robot.body
    compiler = root.find("compiler")
    if compiler is None:
        compiler = ElementTree.SubElement(root, "compiler")
    compiler.set("inertiafromgeom", "false")
    root.insert(1, Element("option", gravity=_row(robot.body.gravity)))
    for geom in root.iter("geom"):
        geom.set("conaffinity", "0")


def _note(root: Element, found: Physical, remark: str, rows: Sequence[Interval]) -> None:
    """Write the command, and the parameters with their intervals as data that MuJoCo reads."""
    root.insert(0, ElementTree.Comment(f" {remark.replace('--', '- -')} "))
    custom = ElementTree.SubElement(root, "custom")
    told = " parameters: here, identified, and the ends of the 95 % interval where it is known "
    custom.append(ElementTree.Comment(told))
    for row, here in zip(rows, found.base, strict=False):  # the rest of rows are constants of terms
        data = [here, row.estimate, *([row.low, row.high] if row.known else [])]
        ElementTree.SubElement(custom, "numeric", name=row.name, data=_row(data))


def _row(numbers: Any) -> str:
    return " ".join(repr(float(x)) for x in numbers)
