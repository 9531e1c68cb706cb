"""Run `scarid simulate`."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.sensors import building
from scarid_cli.cli.imperfections import imperfections as chosen
from scarid_cli.cli.job import Job, per_joint
from scarid_cli.stages import simulate as stage
from scarid_cli.stages.realtime import PART, Lateness, in_parts, paced


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
        **building.in_the_loop(given, arm.joints, control_rate),
    )
    reference = job.recorded(table)
    if not realtime:
        job.write(stage.simulate(reference, loop, log_rate, truth=truth, given=given))
        return
    reference, lateness = in_parts(reference), Lateness()
    log = stage.simulate(reference, loop, log_rate, truth=truth, given=given)
    job.write(paced(log, lateness))
    if lateness.last > max(PART, 1.0 / log_rate):
        job.say(
            f"warning: too slow for real time: the last row came {lateness.last:.3g} s late, the "
            f"worst one {lateness.worst:.3g} s; lower --control-rate, --substeps or --log-rate"
        )
    elif lateness.worst > 1.0 / log_rate:
        job.say(f"in real time; the worst row came {1e3 * lateness.worst:.3g} ms late")
