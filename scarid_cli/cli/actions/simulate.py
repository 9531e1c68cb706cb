"""Run `scarid simulate`."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.cli.job import Job, per_joint
from scarid_cli.stages import simulate as stage


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
    control_rate: float,
    log_rate: float,
    substeps: int,
    encoder_bits: int | None,
    position_noise: tuple[float, ...],
    torque_noise: tuple[float, ...] | None,
    seed: int,
    truth: bool,
) -> None:
    """Write what the simulated sensors measure."""
    table, arm = job.read_for(file, "trajectory", robot)
    joints = arm.joints

    def each(given: tuple[float, ...] | None, own: Any, option: str) -> Any:
        return np.array(per_joint(given, len(joints), option) if given else own, dtype=float)

    resolutions = [
        joint.encoder_resolution
        if encoder_bits is None or joint.type == "prismatic"
        else (2.0 * pi / 2**encoder_bits if encoder_bits else 0.0)
        for joint in joints
    ]
    loop = ClosedLoop(
        robot=arm,
        law=law(
            arm,
            control,
            bandwidth,
            **{
                name: each(given, None, f"--{name}") if given else None
                for name, given in (("kp", kp), ("kd", kd), ("ki", ki))
            },
        ),
        encoder_resolution=np.array(resolutions),
        position_noise=each(position_noise, None, "--position-noise"),
        torque_noise=each(torque_noise, [j.torque_noise for j in joints], "--torque-noise"),
        seed=seed,
        control_rate=control_rate,
        substeps=substeps,
    )
    job.write(stage.simulate(job.recorded(table), loop, log_rate, truth=truth))
