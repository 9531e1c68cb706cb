"""scarid trajgen"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.cli import options
from scarid_cli.cli.described import describing
from scarid_cli.cli.options import NUMBERS

if TYPE_CHECKING:
    from scarid_cli.algorithms.robots.description import Robot
    from scarid_cli.algorithms.trajectories.limits import Limits
    from scarid_cli.arrays import Array

MOST = 1e9  # a limit of this size is none


@click.command(name="trajgen", cls=describing(EXCITATIONS, "Excitations and their settings"))
@options.robot
@click.option(
    "--excitation",
    type=click.Choice(EXCITATIONS.names),
    default="quintic",
    show_default=True,
    help="The kind of motion; see below.",
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    help="A setting of the excitation; may be repeated.",
)
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the random motion.")
@click.option(
    "--duration", type=float, default=20.0, show_default=True, help="Length of the motion [s]."
)
@click.option(
    "--segment",
    type=float,
    nargs=2,
    metavar="SHORTEST LONGEST",
    help="Range of the time from one via point to the next [s]; short for --set shortest=SHORTEST "
    "--set longest=LONGEST.  [default: 0.8 2.0]",
)
@click.option(
    "--sequential",
    is_flag=True,
    help="Move one joint at a time, as in the paper; short for --excitation sequential.",
)
@click.option(
    "--via",
    metavar="FILE",
    help="Take the via points from a table with columns t, q1, q2, ... instead of random ones.",
)
@click.option(
    "--home",
    type=NUMBERS,
    help="Position at which the motion starts and ends [rad or m].  [default: zero where the "
    "limits allow it, else the middle between them]",
)
@click.option("--rate", type=float, default=200.0, show_default=True, help="Rows per second [Hz].")
@click.option(
    "--q-max",
    type=NUMBERS,
    help="Upper position limit [rad or m]; without --q-min, its negative is the lower one.  "
    "[default: the robot's]",
)
@click.option(
    "--q-min", type=NUMBERS, help="Lower position limit [rad or m].  [default: the robot's]"
)
@click.option("--dq-max", type=NUMBERS, help="Limit on |dq| [1/s].  [default: the robot's]")
@click.option("--ddq-max", type=NUMBERS, help="Limit on |ddq| [1/s2].  [default: the robot's]")
@options.table_output
@options.common
def command(robot: str | None, seed: int, duration: float, rate: float, **rest: Any) -> None:
    """Generate a trajectory that excites a robot, within its limits.

    \b
      scarid trajgen --seed 1 -o reference.parquet
      scarid trajgen --robot emps --duration 30 --segment 1 4 | scarid simulate
      scarid trajgen --via points.csv --rate 500
      scarid trajgen --robot arm.urdf --ddq-max 5 --home 0,-0.5 -o reference.csv

    The motion starts and ends at rest at the home position and stays within the limits on position,
    velocity and acceleration, which are those of the robot's description unless an option gives
    others. A motion that would leave its limits is refused before anything is written. The
    condition number of the observation matrix W that the motion gives the robot is reported on
    standard error; a motion with a condition number below about 100 excites the robot well.
    """
    from math import isfinite

    from scarid_cli.cli.job import job, robot_of
    from scarid_cli.errors import UsageFault
    from scarid_cli.io.table import Metadata
    from scarid_cli.stages import trajgen as stage

    arm = robot_of(robot)
    if not (rate > 0.0 and isfinite(rate) and duration > 0.0 and isfinite(duration)):
        raise UsageFault("--rate and --duration must be positive")
    limits = _limits(arm, rest)
    home = _home(arm, limits, rest["home"])
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        if rest["via"]:
            from scarid_cli.algorithms.trajectories.via import through

            points, _ = run.read_for(rest["via"], "via", arm.name)
            trajectory: Any = through(stage.via_points(points, arm), limits, home)
        else:
            import numpy as np

            rng = np.random.default_rng(seed)
            trajectory = _excitation(rest).trajectory(limits, home, duration, rng)
        stage.checked(trajectory, limits, rate)
        if wider := _wider(arm, limits):
            run.say(f"joint {wider}: --q-min or --q-max go beyond the limits of the description")
        meta = Metadata(kind="trajectory", robot=arm.name, period=1.0 / rate)
        run.write(run.recorded(stage.tabulate(trajectory, arm, rate, meta)), out)
        run.say(
            f"{arm.name}, {trajectory.duration:g} s, {trajectory.summary}, "
            + stage.conditioning(trajectory, arm, rate)
        )


def _excitation(rest: dict[str, Any]) -> Any:
    """The excitation that was chosen, with the settings that were given."""
    from scarid_cli.algorithms.choices.settings import names_of
    from scarid_cli.cli.pairs import pair, require_known
    from scarid_cli.errors import UsageFault

    name = "sequential" if rest["sequential"] else rest["excitation"]
    given = dict(zip(("shortest", "longest"), rest["segment"] or (), strict=False))
    for text in rest["settings"]:
        key, value = pair(text, "--set")
        try:
            given[key] = float(value)
        except ValueError:
            raise UsageFault(f"--set {text}: {value!r} is not a number") from None
    method = EXCITATIONS.load(name)
    for key in given:
        require_known(names_of(method), key, name)
    return method(**given)


def _limits(arm: Robot, rest: dict[str, Any]) -> Limits:
    """The limits of the robot's description, or those that were given instead."""
    import numpy as np

    from scarid_cli.algorithms.trajectories.limits import Limits
    from scarid_cli.cli.job import per_joint
    from scarid_cli.errors import UsageFault

    own = Limits.of(arm.joints)

    def row(option: str, otherwise: Array, *, positive: bool = True) -> Array:
        given = rest[option.strip("-").replace("-", "_")]
        values = np.array(per_joint(given, len(arm.joints), option)) if given else otherwise
        if not (np.abs(values) < MOST).all() or (positive and not (values > 0.0).all()):
            lack = "" if given else f" (the description of {arm.name} gives none)"
            what = "positive and finite" if positive else "finite"
            raise UsageFault(f"{option}: the bounds must be {what}{lack}")
        return values

    symmetric = bool(rest["q_max"]) and not rest["q_min"]
    upper = row("--q-max", own.upper, positive=symmetric)
    lower = row("--q-min", -upper if symmetric else own.lower, positive=False)
    for joint in np.flatnonzero(lower >= upper):
        raise UsageFault(
            f"--q-min: the lower bound of joint {joint + 1}, {lower[joint]:g}, must be below its "
            f"upper bound, {upper[joint]:g}"
        )
    return Limits(lower, upper, row("--dq-max", own.dq), row("--ddq-max", own.ddq))


def _wider(arm: Robot, limits: Limits) -> str:
    """The joints (from 1) whose position limits are wider than those of the description."""
    return ", ".join(
        str(i)
        for i, joint in enumerate(arm.joints, start=1)
        if limits.lower[i - 1] < joint.lower or limits.upper[i - 1] > joint.upper
    )


def _home(arm: Robot, limits: Limits, given: tuple[float, ...] | None) -> Array:
    """The home position (joints), which must lie within the limits."""
    import numpy as np

    from scarid_cli.cli.job import per_joint
    from scarid_cli.errors import UsageFault

    home = np.array(per_joint(given, len(arm.joints), "--home")) if given else limits.home
    for (joint,) in limits.outside(home):
        raise UsageFault(
            f"--home: joint {joint + 1} at {home[joint]:g} is outside its position limits, "
            f"{limits.interval(joint)}"
        )
    return home
