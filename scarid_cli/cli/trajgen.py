"""scarid trajgen"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options
from scarid_cli.cli.options import NUMBERS


@click.command(name="trajgen")
@options.robot
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the via points.")
@click.option(
    "--duration", type=float, default=20.0, show_default=True, help="Length of the motion [s]."
)
@click.option(
    "--segment",
    type=float,
    nargs=2,
    default=(0.8, 2.0),
    show_default=True,
    metavar="SHORTEST LONGEST",
    help="Time from one via point to the next [s].",
)
@click.option(
    "--sequential",
    is_flag=True,
    help="Move one joint at a time while the others are locked (the paper's test movements).",
)
@click.option(
    "--via",
    type=options.INPUT,
    metavar="FILE",
    help="Take the via points from a table with columns t, q1, q2, ...",
)
@click.option("--rate", type=float, default=200.0, show_default=True, help="Rows per second [Hz].")
@click.option("--q-max", type=NUMBERS, help="Bound on |q| [rad or m].  [default: the robot's]")
@click.option("--dq-max", type=NUMBERS, help="Bound on |dq| [1/s].  [default: the robot's]")
@click.option("--ddq-max", type=NUMBERS, help="Bound on |ddq| [1/s2].  [default: the robot's]")
@options.table_output
@options.common
def command(
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
    **rest: Any,
) -> None:
    """Generate an excitation trajectory.

    \b
      scarid trajgen --seed 1 -o reference.parquet
      scarid trajgen --robot emps --duration 30 --segment 1 4 | scarid simulate
      scarid trajgen --via points.csv --rate 500

    Fifth-order polynomials between via points, at rest at each of them, starting and ending at
    zero (paper eq. 28). The bounds on position, velocity and acceleration hold by construction;
    via points of yours that break them are refused. The condition number of the observation
    matrix W that the trajectory gives the robot is told on standard error; below about 100 is well
    excited.
    """
    from math import isfinite

    import numpy as np

    from scarid_cli.algorithms.trajectories import quintic
    from scarid_cli.cli.job import job, per_joint, robot_of
    from scarid_cli.errors import UsageFault
    from scarid_cli.io.table import Metadata
    from scarid_cli.stages import trajgen as stage

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
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        if via:
            points, _ = run.read_for(via, "via", arm.name)
            path = quintic.through(stage.via_points(points, arm), bounds)
        else:
            rng = np.random.default_rng(seed)
            path = quintic.random_path(bounds, duration, segment, rng, sequential=sequential)
        meta = Metadata(kind="trajectory", robot=arm.name, period=1.0 / rate)
        run.write(run.recorded(stage.tabulate(path, arm, rate, meta)), out)
        run.say(
            f"{arm.name}, {path.duration:g} s, {len(path.times) - 1} segments, "
            + stage.excitation(path, arm, rate)
        )
