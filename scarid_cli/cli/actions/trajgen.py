"""Run `scarid trajgen`."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.algorithms.trajectories.via import through
from scarid_cli.arrays import Array
from scarid_cli.cli.job import Job, per_joint, robot_of
from scarid_cli.cli.pairs import require_known, single_settings
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Metadata
from scarid_cli.stages import trajgen as stage

LARGEST_LIMIT = 1e9  # a limit of this size is none


def run(
    job: Job, *, robot: str | None, seed: int, duration: float, rate: float, **given: Any
) -> None:
    """Write the trajectory, and report how well it excites the robot."""
    arm = robot_of(robot)
    if not (rate > 0.0 and isfinite(rate) and duration > 0.0 and isfinite(duration)):
        raise UsageFault("--rate and --duration must be positive")
    asked = _limits(arm, given)
    limits = asked.within(Limits.of(arm.joints))
    home = _home(arm, limits, given["home"])
    if given["via"]:
        points, _ = job.read_for(given["via"], "via", arm.name)
        trajectory: Trajectory = through(stage.via_points(points, arm), limits, home)
    else:
        rng = np.random.default_rng(seed)
        trajectory = _excitation(given).trajectory(limits, home, duration, rng)
    stage.checked(trajectory, limits, rate)
    if narrowed := _narrowed(asked, limits):
        job.say(f"joint {narrowed}: the description has narrower limits than given, and these hold")
    meta = Metadata(kind="trajectory", robot=arm.name, period=1.0 / rate)
    job.write(job.recorded(stage.tabulate(trajectory, arm, rate, meta)))
    job.say(
        f"{arm.name}, {trajectory.duration:g} s, {trajectory.summary}, "
        + stage.conditioning(trajectory, arm, rate)
    )


def _excitation(given: dict[str, Any]) -> Any:
    """The excitation that was chosen, with the settings that were given."""
    name = "sequential" if given["sequential"] else given["excitation"]
    method = EXCITATIONS.load(name)
    known = names_of(method)
    values = dict(zip(("shortest", "longest"), given["segment"] or (), strict=False))
    for key in values:
        require_known(known, key, name)
    return method(**{**values, **single_settings(given["settings"], known, name)})


def _limits(arm: Robot, given: dict[str, Any]) -> Limits:
    """The limits of the robot's description, or those that were given instead."""
    own = Limits.of(arm.joints)

    def row(option: str, otherwise: Array, *, positive: bool = True) -> Array:
        numbers = given[option.strip("-").replace("-", "_")]
        values = np.array(per_joint(numbers, len(arm.joints), option)) if numbers else otherwise
        if not (np.abs(values) < LARGEST_LIMIT).all() or (positive and not (values > 0.0).all()):
            lack = "" if numbers else f" (the description of {arm.name} gives none)"
            what = "positive and finite" if positive else "finite"
            raise UsageFault(f"{option}: the bounds must be {what}{lack}")
        return values

    symmetric = bool(given["q_max"]) and not given["q_min"]
    upper = row("--q-max", own.upper, positive=symmetric)
    lower = row("--q-min", -upper if symmetric else own.lower, positive=False)
    return Limits(lower, upper, row("--dq-max", own.dq), row("--ddq-max", own.ddq))


def _narrowed(asked: Limits, limits: Limits) -> str:
    """The joints (from 1) for which the description has narrower limits than were asked for."""
    pairs = zip(vars(asked).values(), vars(limits).values(), strict=True)
    differ = np.any([one != other for one, other in pairs], axis=0)
    return ", ".join(str(i + 1) for i in np.flatnonzero(differ))


def _home(arm: Robot, limits: Limits, given: tuple[float, ...] | None) -> Array:
    """The home position (joints), which must lie within the limits."""
    home = np.array(per_joint(given, len(arm.joints), "--home")) if given else limits.home
    for (joint,) in limits.outside(home):
        raise UsageFault(
            f"--home: joint {joint + 1} at {home[joint]:g} is outside its position limits, "
            f"{limits.interval(joint)}"
        )
    return home
