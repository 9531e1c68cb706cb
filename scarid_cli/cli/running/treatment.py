"""How the options of `options.treatment` treat the rows of the regression."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from scarid_cli.algorithms.regression.counting import Counting, LeftOut
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.running.job import Job, per_joint
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.procedure.blind import counted


def treatment_of(given: dict[str, Any]) -> Treatment:
    """The treatment that the options ask for, before the robot is known."""
    factors, smooth = given["decimate"] or (), given["smooth_sign"]
    skip = [*(given["skip"] or (0.0,)), 0.0]
    if len(skip) > 3 or any(rows % 1 or rows < 0 for rows in skip):
        raise UsageFault(
            "--skip: give one number of rows, at the start, or two: at the start and at the end"
        )
    if any(factor % 1 or factor < 2 for factor in factors):
        raise UsageFault("--decimate: factors must be whole numbers of at least 2")
    if smooth is not None and not smooth > 0.0:
        raise UsageFault(f"--smooth-sign must be positive, not {smooth:g}")
    return Treatment(
        skip=(int(skip[0]), int(skip[1])),
        decimate=tuple(map(int, factors)),
        slow=slow_of(given),
        align=bool(given.get("align")),
        essential=given.get("essential", False),
        consistent=given.get("consistent", False),
        choose_friction=given.get("friction") == "auto",
        gain_errors=_part(given.get("torque_gain_error") or "0", "--torque-gain-error"),
    )


def _part(text: str, option: str) -> float:
    """A part of one: `1%` or `0.01`."""
    try:
        part = float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        part = -1.0
    if not 0.0 <= part < 1.0:
        raise UsageFault(f"{option} {text}: give a part of one, such as 1% or 0.01")
    return part


def slow_of(given: dict[str, Any]) -> tuple[float, ...]:
    """The velocities of --drop-slow."""
    slow = tuple(given["drop_slow"] or ())
    if any(not v >= 0.0 for v in slow):
        raise UsageFault("--drop-slow: velocities cannot be negative")
    return slow


def for_robot(robot: Robot, treatment: Treatment, given: dict[str, Any]) -> tuple[Robot, Treatment]:
    """The robot with smoothed Coulomb friction, and the treatment with one velocity per joint."""
    smooth, of_joints = given["smooth_sign"], with_slow(robot, treatment)
    return robot.smoothed(smooth) if smooth else robot, of_joints


def with_slow(robot: Robot, treatment: Treatment) -> Treatment:
    """The treatment with one velocity per joint."""
    if not treatment.slow:
        return treatment
    return replace(
        treatment, slow=tuple(per_joint(treatment.slow, len(robot.joints), "--drop-slow"))
    )


def for_motion(motion: Metadata, treatment: Treatment, given: dict[str, Any]) -> Treatment:
    """The treatment, with the rows of this motion that count."""
    if given["all_rows"]:
        return treatment
    return replace(treatment, counting=counted(motion, given["bandwidth"]))


def report(job: Job, table: Table, counting: Counting | None, left_out: dict[str, Any]) -> None:
    """Report which rows were left out, and what could not be known about them."""
    if not counting:
        return
    text = LeftOut(**left_out).text
    if text:
        job.say(f"left out {text} (--all-rows keeps them)")
    if not counting.bandwidth and "settled" in table.columns:
        job.say(
            "rows near reversals are used, because the bandwidth of the motion is not known: give "
            "--bandwidth HZ, or keep the motion in a format with metadata (--format arrow)"
        )


def lead(delay: float) -> str:
    """By what time the torques lead the motion [s], or lag behind it."""
    return f"torques {'lead' if delay >= 0.0 else 'lag'} by {1e3 * abs(delay):.3g} ms"


def behind_low_pass(delay: float) -> str:
    """The end of the clause that torques lead by a delay [s], if a low-pass causes it."""
    return f", as behind a low-pass of {0.5 / (math.pi * abs(delay)):.3g} Hz"
