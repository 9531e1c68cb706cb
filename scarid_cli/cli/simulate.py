"""The declaration of `scarid simulate`."""

from __future__ import annotations

import click

from scarid_cli.cli.declaring import options
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.headings import OUTPUT, heading
from scarid_cli.cli.declaring.imperfections import WithImperfections
from scarid_cli.cli.declaring.options import NUMBERS

GAINS = options.Numbers(options.Range(-1e12, 1e12))


@declare("simulate", WithImperfections)
@options.table_input
@heading("The robot")
@options.robot
@click.option(
    "--with",
    "imperfections",
    multiple=True,
    metavar="NAME=VALUE[,VALUE...]",
    shell_complete=options.offered("imperfections"),
    help="An imperfection of the robot, its sensors or its log, one value for all joints or one "
    "per joint; repeatable. They are listed below.  [default: those of the description]",
)
@click.option(
    "--encoder-bits",
    type=NUMBERS,
    help="The same as --with encoder-bits=...; 0 for perfect ones.  [default: the robot's]",
)
@click.option(
    "--position-noise",
    type=NUMBERS,
    help="The same as --with position-noise=...  [default: the robot's]",
)
@click.option(
    "--torque-noise",
    type=NUMBERS,
    help="The same as --with torque-noise=...  [default: the robot's]",
)
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the noise."
)
@heading("The controller")
@click.option(
    "--control",
    type=click.Choice(("pd", "pid", "pd-gravity", "computed-torque")),
    help="Controller.  [default: the robot's, or computed-torque]",
)
@click.option(
    "--bandwidth",
    type=options.RATE,
    help="Bandwidth from which the gains are found [Hz].  [default: the robot's gains, or 5]",
)
@click.option("--kp", type=GAINS, help="Proportional gains.  [default: see --bandwidth]")
@click.option("--kd", type=GAINS, help="Derivative gains.  [default: see --bandwidth]")
@click.option(
    "--ki",
    type=GAINS,
    help="Integral gains.  [default: the robot's; else from --bandwidth for pid, and 0]",
)
@click.option(
    "--soft-sensor",
    metavar="METHOD[,NAME=VALUE...]",
    help="Close the loop with the velocities of a causal method of `differentiate`, row by row, as "
    "in paper eq. 29. How well the loop follows is reported. `preset=NAME` names a preset.  "
    "[default: the smoothed difference of the readings]",
)
@click.option(
    "--control-rate",
    type=options.RATE,
    default=1000.0,
    show_default=True,
    help="Control rate [Hz].",
)
@click.option(
    "--substeps",
    type=click.IntRange(1, 1000),
    default=2,
    show_default=True,
    help="Runge-Kutta steps per period of the controller.",
)
@heading(OUTPUT)
@click.option(
    "--log-rate",
    type=options.RATE,
    default=200.0,
    show_default=True,
    help="Rows of the log per second [Hz].",
)
@click.option(
    "--truth", is_flag=True, help="Add the true q, dq, ddq and tau as columns q1_true, ..."
)
@click.option(
    "--realtime",
    cls=options.Unrecorded,
    is_flag=True,
    help="Write each row when its time has come, as the robot would.",
)
@options.table_output
@options.common
def command() -> None:
    """Simulate a robot that follows a trajectory in closed loop, and log its sensors.

    \b
      scarid trajgen --seed 1 | scarid simulate --seed 1 -o log.parquet
      scarid simulate --encoder-bits 13 --truth reference.parquet > log.csv
      scarid simulate --with torque-delay=0.002 --with lost-rows=0.001 reference.csv
      scarid simulate --kp 6.5,155 --kd 5,25 reference.csv   # the gains printed in the paper
      scarid trajgen --seed 1 | scarid simulate --soft-sensor p2smd,gamma0=250,gamma1=200
      scarid trajgen --robot arm.urdf --ddq-max 5 | scarid simulate --control pd-gravity
      scarid trajgen --seed 1 --duration 2 | scarid simulate --realtime | scarid differentiate

    The robot has the a priori parameters of its description and starts at rest at the first
    position of the trajectory. With e = q_ref - q, the controllers are (paper eq. 29, its sign
    corrected):

    \b
      pd               tau = Kp e + Kd de/dt
      pid              tau = Kp e + Kd de/dt + Ki integral(e)
      pd-gravity       the torque of pid, plus gravity g(q)
      computed-torque  tau = M(q) (ddq_ref + Kp e + Kd de/dt + Ki integral(e)) + h(q, dq) + friction

    where dq is the differentiated and smoothed reading of the encoder, or that of --soft-sensor.
    Gravity, M, h (gravity, centrifugal and Coriolis torques) and the friction at dq_ref are those
    of the description. Gains that the description does not give are found from --bandwidth: two
    equal poles for the typical inertia of each joint. Coulomb friction holds joints at rest. The
    motion is integrated by the Runge-Kutta method of fourth order, whose steps end where a joint
    stops or begins to slide.
    """
