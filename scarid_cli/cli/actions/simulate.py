"""Run `scarid simulate`."""

from __future__ import annotations

from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.sensors import building
from scarid_cli.cli.imperfections import imperfections as chosen
from scarid_cli.cli.job import Job, per_joint
from scarid_cli.errors import UsageFault
from scarid_cli.stages import simulate as stage


def run(
    job: Job,
    *,
    file: str,
    robot: str | None,
    kp: tuple[float, ...] | None,
    kd: tuple[float, ...] | None,
    ki: tuple[float, ...] | None,
    control_rate: float,
    log_rate: float,
    substeps: int,
    imperfections: tuple[str, ...],
    seed: int,
    truth: bool,
    **shorthands: tuple[float, ...] | None,
) -> None:
    """Write what the simulated sensors measure."""
    table, arm = job.read_for(file, "trajectory", robot)
    joints = arm.joints
    if arm.control is None:
        raise UsageFault(
            f"robot {arm.name} cannot be simulated: its description has no [control]; add one"
        )

    def each(given: tuple[float, ...] | None, own: Any, option: str) -> Any:
        return np.array(per_joint(given, len(joints), option) if given else own, dtype=float)

    given = chosen(imperfections, shorthands, arm.imperfections, len(joints))
    loop = ClosedLoop(
        robot=arm,
        kp=each(kp, arm.control.kp, "--kp"),
        kd=each(kd, arm.control.kd, "--kd"),
        ki=each(ki, arm.control.ki, "--ki"),
        velocity_cutoff=arm.control.velocity_cutoff,
        seed=seed,
        control_rate=control_rate,
        substeps=substeps,
        **building.in_the_loop(given, joints, control_rate),
    )
    job.write(stage.simulate(job.recorded(table), loop, log_rate, truth=truth, given=given))
