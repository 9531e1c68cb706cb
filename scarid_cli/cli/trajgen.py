"""The declaration of `scarid trajgen`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import EXCITATIONS
from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.described import describing
from scarid_cli.cli.declaring.headings import ERRORS, heading
from scarid_cli.cli.declaring.options import NUMBERS


@declare("trajgen", describing(EXCITATIONS, "Excitations"))
@heading("The motion")
@options.robot
@click.option(
    "--excitation",
    type=click.Choice(EXCITATIONS.names),
    help="The kind of motion; see below.  [default: quintic, or spline with --optimise]",
)
@options.settings_of("excitation")
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Seed of the random motion, or of the random starts of --optimise.",
)
@click.option(
    "--duration",
    type=options.DURATION,
    default=20.0,
    show_default=True,
    help="Length of the motion [s].",
)
@click.option(
    "--segment",
    type=options.Number(options.Range(1e-3, 1e6)),
    nargs=2,
    metavar="SHORTEST LONGEST",
    help="Shortest and longest time between via points [s]; short for --set shortest=SHORTEST "
    "--set longest=LONGEST.  [default: 0.8 2.0]",
)
@click.option(
    "--sequential",
    is_flag=True,
    help="Move one joint at a time, as in the paper; short for --excitation sequential.",
)
@click.option(
    "--via",
    type=options.INPUT,
    metavar="FILE",
    help="Take the via points from a table with columns t, q1, q2, ... instead of random ones.",
)
@click.option(
    "--home",
    type=NUMBERS,
    help="Position at which the motion starts and ends [rad or m].  [default: zero in the "
    "middle half of the limits, else their middle]",
)
@click.option(
    "--approach",
    type=NUMBERS,
    help="Begin with a slow motion from this posture to the home position [rad or m].",
)
@click.option(
    "--repeat",
    type=click.IntRange(1, 100_000),
    default=1,
    show_default=True,
    help="How often the motion is repeated.",
)
@click.option(
    "--rate", type=options.RATE, default=200.0, show_default=True, help="Rows per second [Hz]."
)
@heading("The limits")
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
@click.option(
    "--workspace",
    type=NUMBERS,
    metavar="XMIN,XMAX,YMIN,YMAX,ZMIN,ZMAX",
    help="Box that the tool must not leave, in the frame of the base [m].  Needs --optimise.",
)
@heading("The best motion")
@click.option("--optimise", is_flag=True, help="Find the best motion; see --criterion.")
@click.option(
    "--criterion",
    type=click.Choice(("balanced", "d", "a", "c", "scaled-c")),
    help="What makes a motion the best: a small volume of the error ellipsoid (d), small errors of "
    "the torques that parameters stand for (a), a small condition number of W (c) or of its scaled "
    "columns (scaled-c), or d and c in equal parts (balanced).  Needs --optimise.  [default: "
    "balanced; d with --for]",
)
@click.option(
    "--for",
    "wanted",
    metavar="NAME,...|gains|payload",
    shell_complete=options.offered("aims"),
    help="Optimise the errors of these parameters alone, the others being nuisance parameters; or "
    "those of the gains of the torques beside one another (`identify --free-gains`); or those of a "
    "payload (`payload`).  Needs --optimise.",
)
@click.option(
    "--after",
    type=options.INPUT,
    metavar="FILE",
    help="A parameter table of earlier experiments, which the motion is to complement.",
)
@click.option(
    "--budget", type=options.DURATION, metavar="SECONDS",
    help="Time for the random starts of --optimise.  Needs --optimise.  [default: 10]",
)  # fmt: skip
@click.option(
    "--starts",
    type=click.IntRange(1, 100_000),
    help="Number of random starts instead of a time, which gives the same motion each time.  Needs "
    "--optimise.  [default: as many as --budget allows]",
)
@heading(ERRORS)
@options.side_output(
    "--expected", help="Write the expected error of each parameter to FILE, a table."
)
@click.option(
    "--torque-noise",
    type=NUMBERS,
    help="Standard deviation of the logged torques, for the errors that are predicted [N m or N].  "
    "[default: that of --after, else the robot's]",
)
@click.option(
    "--drop-slow",
    type=NUMBERS,
    metavar="V[,V...]",
    help="Predict errors for `identify` with this option, which leaves out rows of slow joints.",
)
@click.option(
    "--align",
    is_flag=True,
    help="Predict errors for `identify` with this option, which also fits a delay.  Needs "
    "--expected or --optimise.",
)
@options.table_output
@options.common
def command() -> None:
    """Generate a trajectory that excites a robot, within its limits.

    \b
      scarid trajgen --seed 1 -o reference.parquet
      scarid trajgen --robot emps --duration 30 --segment 1 4 | scarid simulate --robot emps
      scarid trajgen --via points.csv --rate 500
      scarid trajgen --robot arm.urdf --ddq-max 5 --home 0,-0.5 -o reference.csv
      scarid trajgen --robot arm.toml --optimise -o reference.parquet
      scarid trajgen --robot scara2 --seed 1 --expected errors.csv -o reference.parquet
      scarid trajgen --robot arm.toml --optimise --after parameters.parquet -o next.parquet
      scarid trajgen --robot arm.urdf --optimise --for payload -o weigh.parquet

    The motion starts and ends at rest at the home position and stays within the limits on position,
    velocity and acceleration, which are those of the robot's description unless an option narrows
    them. A motion that would leave its limits is refused before anything is written. The
    condition number of the robot's observation matrix W along the motion is reported on standard
    error; about 30 is good for a few parameters, 100 to 1000 for six axes.

    --optimise also keeps the torque limits, computed with the a priori parameters, and keeps links
    apart whose shapes are described. It reports what limits the motion, and the error of each
    parameter to expect from torques with white noise.
    """
