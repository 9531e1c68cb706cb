"""Whether positions, velocities and torques are in the units and within the limits of the robot."""

from __future__ import annotations

from math import pi

import numpy as np

from scarid_cli.algorithms.checks.finding import TORQUES, Finding, failed, joints_text, ok, warning
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

# By the type of a joint: another unit than ours, its factor, and its name.
OTHER_UNITS = {"revolute": ("deg", pi / 180.0, "degrees"), "prismatic": ("mm", 1e-3, "mm")}
TURNS = 4.0 * pi  # rad: joints without limits turn twice; arms with cables do not turn further
FAST = 20.0  # rad/s: no joint of an arm is faster, where the description has no limit
SPARE = 1.05  # of a limit: a controller overshoots by a few percent
FAR = 2.0  # times a limit: degrees are 57 times too large, and overshoot is less than half of it
# Wrong prefixes are factors of a thousand, so anything nearer to a thousand than to one is taken
# for one of them.
THOUSAND = 1000.0**0.5
IDLE = 0.003  # of all limits: a log in kN m is below it if no torque exceeds three times its limit
GEAR = 6.0  # times a limit: less is a limit of the cell or of an older description, more a gear


def positions(
    log: Log, robot: Robot, speeds: Array, *, with_velocities: bool = False
) -> tuple[Finding, Array]:
    """Positions and `speeds` (joints) [per s], the highest that are not noise, against the limits.

    Also the factors (joints) that bring positions that are in degrees to rad, and in mm to m. The
    velocities of the log, if it has any, are in the unit of the positions `with_velocities`.
    """
    factors = np.ones(log.joints)
    reach = np.nanmax(np.abs(log.q), axis=1)
    outside = [i for i in range(log.joints) if _excess(log.q[i], robot, i, speeds[i]) > SPARE]
    if not outside:
        within = ", ".join(f"{x:.3g}" for x in reach)
        return ok("positions", f"up to {within} {_units(robot)}, within the limits"), factors
    names = joints_text(i + 1 for i in outside)
    likely = _alike(robot, outside)
    far_out = all(_in_other_unit(log.q[i], robot, i, speeds[i]) for i in outside)
    if far_out and not _turned(robot, likely, reach):
        figure = f"{names} up to {reach[outside].max():.3g}, far outside the limits"
        for i in likely:
            factors[i] = OTHER_UNITS[robot.joints[i].type][1]
        return failed(
            "positions", figure, _converted(robot, outside, likely, velocities=with_velocities)
        ), factors
    excess = max(_excess(log.q[i], robot, i, speeds[i]) for i in outside)
    resting = max(_excess(log.q[i], robot, i, 0.0) for i in outside)
    inside = resting <= SPARE
    figure = f"{names} at {excess:.3g} times the {'velocity limit' if inside else 'limits'}"
    figure += f" of {robot.short_name}"
    question = "is this the robot, and is a position that of the motor (gear_ratio, zero, unit)?"
    limited = all(np.isfinite(robot.joints[i].upper - robot.joints[i].lower) for i in outside)
    far = excess > GEAR and not (inside and limited)
    return (failed if far else warning)("positions", figure, question), factors


def _alike(robot: Robot, outside: list[int]) -> list[int]:
    """The joints whose positions are likely to be in the other unit of those far outside.

    A log has one unit for a type of joint, and joints that move little are within their limits in
    any; but if most are within, only those outside are in another one.
    """
    found = []
    for kind in OTHER_UNITS:
        own = [i for i in outside if robot.joints[i].type == kind]
        every = [i for i, joint in enumerate(robot.joints) if joint.type == kind]
        found += every if 2 * len(own) > len(every) else own
    return sorted(found)


def _turned(robot: Robot, likely: list[int], reach: Array) -> bool:
    """Whether one of these joints (from 0), and not all, may be up to a turn from its zero instead.

    `reach` (joints) are the largest positions.
    """
    for i in likely:
        kind = robot.joints[i].type
        others = [
            k for k, joint in enumerate(robot.joints) if joint.type == kind and k not in likely
        ]
        limit = max(abs(robot.joints[i].lower), abs(robot.joints[i].upper))
        if others and kind == "revolute" and reach[i] <= limit + 2.0 * pi:
            return True
    return False


def _converted(robot: Robot, outside: list[int], likely: list[int], *, velocities: bool) -> str:
    """What to type for positions in another unit, of these joints or of those outside limits.

    And for their velocities, if these are in it.
    """
    kinds = dict.fromkeys(robot.joints[i].type for i in outside)
    names = " and ".join(OTHER_UNITS[kind][2] for kind in kinds)
    typed = _options(robot, likely)
    if velocities:
        typed += " " + _options(robot, likely, "dq", "/s")
    text = f"positions seem to be in {names}: `scarid convert {typed}`"
    every = [i for i, joint in enumerate(robot.joints) if joint.type in kinds]
    if likely != outside:
        return f"{text}, or `{_options(robot, outside)}` if only these are"
    if len(every) > len(likely):
        return f"{text}, or `{_options(robot, every)}` if all are"
    return text


def _options(robot: Robot, joints: list[int], name: str = "q", per: str = "") -> str:
    """The options that convert the positions, or what is called so, of these joints (from 0)."""
    units = [f"{OTHER_UNITS[robot.joints[i].type][0]}{per}" for i in joints]
    if len(joints) == len(robot.joints) and len({*units}) == 1:
        return f"--unit '{name}*={units[0]}'"
    pairs = zip(joints, units, strict=True)
    return " ".join(f"--unit {name}{i + 1}={unit}" for i, unit in pairs)


def _units(robot: Robot) -> str:
    return " or ".join(dict.fromkeys(joint.unit for joint in robot.joints))


def _excess(q: Array, robot: Robot, i: int, speed: float) -> float:
    """How far joint i goes beyond its limits, of position or velocity, as a ratio to them."""
    joint = robot.joints[i]
    low, high = np.nanmin(q), np.nanmax(q)
    revolute = joint.type == "revolute"
    limit = joint.velocity_limit or np.inf  # many a URDF has 0 for what is not known
    if not np.isfinite(limit):
        limit = FAST if revolute else np.inf
    upper, lower = joint.upper, joint.lower
    if not np.isfinite(upper - lower):
        upper, lower = (TURNS, -TURNS) if revolute else (np.inf, -np.inf)
    middle, half = (0.0, np.inf) if np.isinf(upper) else ((upper + lower) / 2, (upper - lower) / 2)
    reach = max(high - middle, middle - low) / half if half else 1.0
    return float(max(reach, speed / limit))


def _in_other_unit(q: Array, robot: Robot, i: int, speed: float) -> bool:
    """Whether joint i is within its limits if its position is in degrees or mm, else far out.

    A position that is no larger than its limits is in their unit, however fast it changes: many a
    velocity limit in a URDF is a placeholder, and an axis may point the other way.
    """
    joint = robot.joints[i]
    _, factor, _ = OTHER_UNITS[joint.type]
    limits = [abs(x) for x in (joint.lower, joint.upper) if np.isfinite(x)]
    excess = _excess(q, robot, i, speed)
    if limits and not np.nanmax(np.abs(q)) > FAR * max(limits):
        return False
    return excess > FAR and _excess(factor * q, robot, i, factor * speed) <= 1.0 + 1.0 / FAR


def torques(log: Log, robot: Robot) -> Finding:
    """Torques against the limits, many of which are placeholders in a URDF.

    `checks.scale` compares them with those that the masses need, which are the better judge.
    """
    reach = np.nanmax(np.abs(log.tau), axis=1)
    limits = np.array([joint.torque_limit or np.inf for joint in robot.joints])
    excess = float(np.max(np.where(np.isfinite(limits), reach / limits, 0.0)))
    figure = f"up to {', '.join(f'{x:.3g}' for x in reach)} {_torque_units(robot)}"
    if excess > THOUSAND:
        figure += f", {excess:.2g} times what {robot.short_name} has"
        advice = prefixed("m", robot)
        large = np.flatnonzero(reach / limits > THOUSAND).tolist()
        if 0 < len(large) < log.joints:
            single = " ".join(f"--unit 'tau{i + 1}=mN m'" for i in large)
            advice += f", or `{single}` if all others are in N m"
        return failed(TORQUES, figure, advice)
    used = float(np.max(reach / limits))
    if np.isfinite(limits).all() and 0.0 < used < IDLE:
        figure += f", at most {used:.2g} of the limits of {robot.short_name}"
        return failed(TORQUES, figure, prefixed("k", robot))
    if excess > SPARE:
        advice = "are these torques of the joints, in N m, of this robot?"
        return warning(TORQUES, f"{figure}, {excess:.3g} times the limit", advice)
    return ok(TORQUES, figure)


def prefixed(prefix: str, robot: Robot) -> str:
    """What to type for torques in thousandths (m) or thousands (k) of the robot's unit."""
    unit = prefix + robot.joints[0].torque_unit
    text = f"torques seem to be in {unit}: `scarid convert --unit 'tau*={unit}'`"
    motors = ', unless they are those of the motors (torques = "motor" in [log] of the TOML file)'
    return text + (motors if prefix == "k" else "")


def _torque_units(robot: Robot) -> str:
    return " or ".join(dict.fromkeys(joint.torque_unit for joint in robot.joints))
