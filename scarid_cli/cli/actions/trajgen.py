"""Run `scarid trajgen`."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.joined import Joined, approach
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.algorithms.trajectories.via import through
from scarid_cli.arrays import Array
from scarid_cli.cli.declaring.pairs import require_known, single_settings
from scarid_cli.cli.running.designing import Asked, Found, asked, optimised
from scarid_cli.cli.running.job import Job, per_joint
from scarid_cli.cli.running.treatment import slow_of, with_slow
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Metadata
from scarid_cli.stages import trajgen as stage
from scarid_cli.stages.design import Prediction

LARGEST_LIMIT = 1e9  # a limit of this size is none
MOST_ROWS = 1e9


def run(
    job: Job, *, robot: str | None, seed: int, duration: float, rate: float, **given: Any
) -> None:
    """Write the trajectory, and report how well it excites the robot."""
    arm = job.robot(robot)
    _require_moderate(rate, duration, given["repeat"])
    given |= {"seed": seed, "duration": duration, "rate": rate}
    treatment = _treatment(arm, given)
    side = job.side_table(given["expected"])
    bounds = _limits(arm, given)
    limits = bounds.within(Limits.of(arm.joints))
    home = _home(arm, limits, given["home"])
    wish = asked(job, arm, given)
    found = _optimised(job, arm, limits, home, wish, given)
    motion = found.curve if found else _motion(job, arm, limits, home, given)
    trajectory = _joined(motion, arm, limits, home, given)
    stage.checked(trajectory, limits, rate)
    _tell_narrowed(job, bounds, limits)
    meta = Metadata(kind="trajectory", robot=arm.name, period=1.0 / rate)
    job.write(job.recorded(stage.tabulate(trajectory, arm, rate, meta)))
    if not (found or side):
        job.say(f"{_about(arm, trajectory)}, {stage.conditioning(trajectory, arm, rate)}")
        return
    prediction = Prediction.of(trajectory, arm, rate, wish.noise, wish.known, treatment)
    _tell(job, _about(arm, trajectory), found, prediction)
    _tell_aim(job, prediction, given)
    if side:
        job.write(job.recorded(prediction.table(replace(meta, period=None))), side)


def _about(arm: Robot, trajectory: Trajectory) -> str:
    return f"{arm.name}, {trajectory.duration:g} s, {trajectory.summary}"


def _tell(job: Job, about: str, found: Found | None, prediction: Prediction) -> None:
    """Say how well the motion excites the robot, and what limits one that was optimised."""
    way = f", the best of {found.starts} starts" if found else ""
    job.say(f"{about}{way}: {prediction.excitation}")
    if found:
        job.say(f"limited by: {found.limited}")
    job.say(prediction.summary)


def _tell_aim(job: Job, prediction: Prediction, given: dict[str, Any]) -> None:
    """Say what the motion will tell about the gains or a payload, if that was asked for."""
    if not given["wanted"] or prediction.noise is None:
        return
    from scarid_cli.stages.aims import PREDICTED

    if tell := PREDICTED.get(given["wanted"]):
        job.say(tell(prediction.robot, prediction.fitted, prediction.noise))


def _require_moderate(rate: float, duration: float, times: int) -> None:
    """Refuse a number of rows that cannot be written."""
    if not (rate > 0.0 and isfinite(rate) and duration > 0.0 and isfinite(duration)):
        raise UsageFault("--rate and --duration must be positive")
    if rate * duration * times > MOST_ROWS:
        raise UsageFault(
            f"--rate {rate:g} over --duration {duration:g} gives more than {MOST_ROWS:g} rows; "
            "lower one of them, or --repeat"
        )


def _treatment(arm: Robot, given: dict[str, Any]) -> Treatment:
    """How `identify` will treat the rows, for the errors that are predicted."""
    for option in ("drop_slow", "align"):
        if given[option] and not (given["expected"] or given["optimise"]):
            raise UsageFault(f"--{option.replace('_', '-')} needs --expected or --optimise")
    return with_slow(arm, Treatment(slow=slow_of(given), align=given["align"]))


def _optimised(
    job: Job, arm: Robot, limits: Limits, home: Array, wish: Asked, given: dict[str, Any]
) -> Found | None:
    """The best motion, if one was asked for."""
    if not given["optimise"]:
        return None
    if given["via"]:
        raise UsageFault("--optimise and --via exclude each other")
    return optimised(job, arm, limits, home, _excitation(given), wish, given)


def _motion(job: Job, arm: Robot, limits: Limits, home: Array, given: dict[str, Any]) -> Trajectory:
    """The motion through the via points that were given, or a random one."""
    if given["via"]:
        points, _ = job.read_for(given["via"], "via", arm.name)
        return through(stage.via_points(points, arm), limits, home)
    rng = np.random.default_rng(given["seed"])
    motion: Trajectory = _excitation(given).trajectory(limits, home, given["duration"], rng)
    return motion


def _joined(
    motion: Trajectory, arm: Robot, limits: Limits, home: Array, given: dict[str, Any]
) -> Trajectory:
    """The motion as often as it is repeated, after the approach."""
    times = given["repeat"]
    if times > 1:
        motion = Joined((motion,) * times, f"{motion.summary}, {times} times")
    if given["approach"]:
        posture = np.array(per_joint(given["approach"], len(arm.joints), "--approach"))
        first = approach(posture, home, limits, given["rate"])
        motion = Joined((first, motion), f"approach of {first.duration:.4g} s, {motion.summary}")
    return motion


def _excitation(given: dict[str, Any]) -> Any:
    """The excitation that was chosen, with the settings that were given."""
    default = "spline" if given["optimise"] else "quintic"
    name = "sequential" if given["sequential"] else given["excitation"] or default
    method = EXCITATIONS.load(name)
    known = names_of(method)
    values = dict(zip(("shortest", "longest"), given["segment"] or (), strict=False))
    for key in values:
        require_known(known, key, name)
    return method(**{**values, **single_settings(given["settings"], known, name)})


def _limits(arm: Robot, given: dict[str, Any]) -> Limits:
    """The limits of the robot's description, or those that were given instead."""
    own = Limits.of(arm.joints)
    _require_limits(arm, own, given)

    def row(option: str, otherwise: Array, *, positive: bool = True) -> Array:
        numbers = given[option.strip("-").replace("-", "_")]
        values = np.array(per_joint(numbers, len(arm.joints), option)) if numbers else otherwise
        if not (np.abs(values) < LARGEST_LIMIT).all() or (positive and not (values > 0.0).all()):
            what = "positive and finite" if positive else "finite"
            raise UsageFault(f"{option}: the bounds must be {what}")
        return values

    symmetric = bool(given["q_max"]) and not given["q_min"]
    upper = row("--q-max", own.upper, positive=symmetric)
    lower = row("--q-min", -upper if symmetric else own.lower, positive=False)
    return Limits(lower, upper, row("--dq-max", own.dq), row("--ddq-max", own.ddq))


def _require_limits(arm: Robot, own: Limits, given: dict[str, Any]) -> None:
    """Refuse a robot without limits that were not given either, and say what to type."""
    lacking = {
        option: f"{quantity}{_of_some(values)}"
        for quantity, option, values in (
            ("position", "--q-max", np.maximum(own.upper, -own.lower)),
            ("velocity", "--dq-max", own.dq),
            ("acceleration", "--ddq-max", own.ddq),
        )
        if not given[option.strip("-").replace("-", "_")] and not (values < LARGEST_LIMIT).all()
    }
    if lacking:
        options = " ".join(f"{option} NUMBERS" for option in lacking)
        raise UsageFault(
            f"the description of {arm.name} has no limits of {', '.join(lacking.values())}: "
            f"type `{options}`"
        )


def _of_some(values: Array) -> str:
    """` (joints 2, 5)`: those without a limit, unless all are."""
    unlimited = [str(j + 1) for j in np.flatnonzero(~(values < LARGEST_LIMIT))]
    if len(unlimited) == len(values):
        return ""
    return f" (joint{'s' if unlimited[1:] else ''} {', '.join(unlimited)})"


def _tell_narrowed(job: Job, asked: Limits, limits: Limits) -> None:
    """Say for which joints the description has narrower limits than were asked for."""
    pairs = zip(vars(asked).values(), vars(limits).values(), strict=True)
    differ = np.flatnonzero(np.any([one != other for one, other in pairs], axis=0))
    if len(differ):
        joints = ", ".join(str(i + 1) for i in differ)
        job.say(f"joint {joints}: the description has narrower limits than given, and these hold")


def _home(arm: Robot, limits: Limits, given: tuple[float, ...] | None) -> Array:
    """The home position (joints), which must lie within the limits."""
    home = np.array(per_joint(given, len(arm.joints), "--home")) if given else limits.home
    for (joint,) in limits.outside(home):
        raise UsageFault(
            f"--home: joint {joint + 1} at {home[joint]:g} is outside its position limits, "
            f"{limits.interval(joint)}"
        )
    return home
