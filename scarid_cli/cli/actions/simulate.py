"""Run `scarid simulate`."""

from __future__ import annotations

from typing import Any

import numpy as np

from scarid_cli.algorithms.plants import building
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.declaring.imperfections import imperfections as chosen
from scarid_cli.cli.running.configured import configured
from scarid_cli.cli.running.job import Job, per_joint
from scarid_cli.errors import UsageFault
from scarid_cli.stages import simulate as stage
from scarid_cli.stages.records.realtime import PART, Lateness, in_parts, paced

LIMITED = 0.01  # of the time: a start from rest, or a push, is shorter


def run(
    job: Job,
    *,
    file: str,
    robot: str | None,
    control: str | None,
    bandwidth: float | None,
    kp: tuple[float, ...] | None,
    kd: tuple[float, ...] | None,
    ki: tuple[float, ...] | None,
    soft_sensor: str | None,
    control_rate: float,
    log_rate: float,
    substeps: int,
    imperfections: tuple[str, ...],
    seed: int,
    truth: bool,
    realtime: bool,
    **shorthands: tuple[float, ...] | None,
) -> None:
    """Write what the simulated sensors measure."""
    table, arm = job.read_for(file, "trajectory", robot)
    joints = len(arm.joints)
    gains = {
        name: np.array(per_joint(values, joints, f"--{name}")) if values else None
        for name, values in (("kp", kp), ("kd", kd), ("ki", ki))
    }
    given = chosen(imperfections, shorthands, arm.imperfections, joints)
    loop = ClosedLoop(
        robot=arm,
        law=law(arm, control, bandwidth, **gains),
        seed=seed,
        control_rate=control_rate,
        substeps=substeps,
        sensors=None if soft_sensor is None else _sensors(soft_sensor, joints),
        **building.in_the_loop(given, arm.joints, control_rate),
    )
    watch = stage.Followed([joint.torque_limit for joint in arm.joints])
    reference, lateness = job.recorded(table), Lateness()
    if realtime:
        reference = in_parts(reference)
    log = stage.simulate(reference, loop, log_rate, truth=truth, given=given, watch=watch)
    job.write(paced(log, lateness) if realtime else log)
    if soft_sensor:
        job.say(_told(soft_sensor, watch, arm))
    if text := _limited(watch, arm):
        job.say(text)
    if realtime:
        _tell_of_lateness(job, lateness, 1.0 / log_rate)


def _limited(watch: stage.Followed, arm: Robot) -> str:
    """Which torques are at their limits, so that the robot does not move as it should."""
    own = [
        f"joint {i} in {100.0 * share:.2g} % ({joint.torque_limit:.3g} {joint.torque_unit})"
        for i, (share, joint) in enumerate(zip(watch.limited, arm.joints, strict=True), start=1)
        if share > LIMITED
    ]
    if not own:
        return ""
    return (
        f"warning: torques are at the limits of {arm.short_name} for a part of the time: "
        f"{', '.join(own)}: the motion is not followed there; give a slower one, or one that "
        "keeps them (`scarid trajgen --optimise`)"
    )


def _tell_of_lateness(job: Job, lateness: Lateness, interval: float) -> None:
    """Report rows that came late, by more than the interval [s] between them."""
    if lateness.last > max(PART, interval):
        job.say(
            f"warning: too slow for real time: the last row came {lateness.last:.3g} s late, the "
            f"worst one {lateness.worst:.3g} s; lower --control-rate, --substeps or --log-rate"
        )
    elif lateness.worst > interval:
        job.say(f"in real time; the worst row came {1e3 * lateness.worst:.3g} ms late")


def _sensors(text: str, joints: int) -> list[Any]:
    """The soft sensor of each joint, which must need no later rows."""
    name, *words = text.split(",")
    preset = next((x.removeprefix("preset=") for x in words if x.startswith("preset=")), None)
    given = tuple(x for x in words if not x.startswith("preset="))
    methods = configured(
        joints, method=name, given=given, preset=preset, settings=None, option="--soft-sensor"
    )
    if not methods[0].is_fitted or methods[0].lag(1e-3) > 0:
        raise UsageFault(
            f"--soft-sensor: {name} needs later rows, which a controller does not have; give a "
            "causal method, such as kalman or p2smd"
        )
    return methods


def _told(sensor: str, watch: stage.Followed, arm: Robot) -> str:
    """How well the loop follows, and how rough its torques are."""
    units = [(x.unit, x.torque_unit) for x in arm.joints]
    parts = [
        f"joint {i} {error:.2g} {unit} and {change:.2g} {torque}"
        for i, (error, change, (unit, torque)) in enumerate(
            zip(watch.errors, watch.changes, units, strict=True), start=1
        )
    ]
    return (
        f"with {sensor} in the loop, tracking errors and changes of the torque from tick to tick "
        f"are (rms): {', '.join(parts)}"
    )
