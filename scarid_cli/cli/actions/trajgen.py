"""Run `scarid trajgen`."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from scarid_cli.algorithms.trajectories import quintic
from scarid_cli.cli.job import Job, per_joint, robot_of
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Metadata
from scarid_cli.stages import trajgen as stage


def run(
    job: Job,
    *,
    robot: str | None,
    seed: int,
    duration: float,
    segment: tuple[float, float],
    sequential: bool,
    via: str | None,
    rate: float,
    q_max: tuple[float, ...] | None,
    dq_max: tuple[float, ...] | None,
    ddq_max: tuple[float, ...] | None,
) -> None:
    """Write the trajectory, and report how well it excites the robot."""
    arm = robot_of(robot)
    if not (rate > 0.0 and isfinite(rate) and duration > 0.0 and isfinite(duration)):
        raise UsageFault("--rate and --duration must be positive")

    def limits(given: tuple[float, ...] | None, name: str) -> Any:
        own = [getattr(joint, f"{name}_limit") for joint in arm.joints]
        option = {"position": "--q-max", "velocity": "--dq-max", "acceleration": "--ddq-max"}[name]
        values = np.array(per_joint(given, len(own), option) if given else own)
        if not ((values > 0.0) & (values < 1e9)).all():
            lack = "" if given else f" (the description of {arm.name} gives none)"
            raise UsageFault(f"{option}: the bounds must be positive and finite{lack}")
        return values

    bounds = quintic.Bounds(
        limits(q_max, "position"), limits(dq_max, "velocity"), limits(ddq_max, "acceleration")
    )
    if via:
        points, _ = job.read_for(via, "via", arm.name)
        path = quintic.through(stage.via_points(points, arm), bounds)
    else:
        rng = np.random.default_rng(seed)
        path = quintic.random_path(bounds, duration, segment, rng, sequential=sequential)
    meta = Metadata(kind="trajectory", robot=arm.name, period=1.0 / rate)
    job.write(job.recorded(stage.tabulate(path, arm, rate, meta)))
    job.say(
        f"{arm.name}, {path.duration:g} s, {len(path.times) - 1} segments, "
        + stage.excitation(path, arm, rate)
    )
