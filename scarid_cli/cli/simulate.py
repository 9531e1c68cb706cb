"""The declaration of `scarid simulate`."""

from __future__ import annotations

import click

from scarid_cli.cli import options
from scarid_cli.cli.declare import declare
from scarid_cli.cli.imperfections import WithImperfections
from scarid_cli.cli.options import NUMBERS


@declare("simulate", WithImperfections)
@options.table_input
@options.robot
@click.option("--kp", type=NUMBERS, help="Proportional gains.  [default: the robot's]")
@click.option("--kd", type=NUMBERS, help="Derivative gains.  [default: the robot's]")
@click.option("--ki", type=NUMBERS, help="Integral gains.  [default: the robot's]")
@click.option(
    "--control-rate", type=float, default=1000.0, show_default=True, help="Control rate [Hz]."
)
@click.option(
    "--log-rate",
    type=float,
    default=200.0,
    show_default=True,
    help="Rows of the log per second [Hz].",
)
@click.option(
    "--substeps",
    type=click.IntRange(min=1),
    default=4,
    show_default=True,
    help="Runge-Kutta steps per period of the controller.",
)
@click.option(
    "--with",
    "imperfections",
    multiple=True,
    metavar="NAME=VALUE[,VALUE...]",
    help="An imperfection of the robot, its sensors or its log, one value for all joints or one "
    "per joint; repeatable. They are listed below.  [default: those of the description]",
)
@click.option(
    "--encoder-bits", type=NUMBERS, help="The same as --with encoder-bits=...; 0 for perfect ones."
)
@click.option("--position-noise", type=NUMBERS, help="The same as --with position-noise=...")
@click.option("--torque-noise", type=NUMBERS, help="The same as --with torque-noise=...")
@click.option(
    "--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the noise."
)
@click.option(
    "--truth", is_flag=True, help="Add the true q, dq, ddq and tau as columns q1_true, ..."
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

    The robot has the a priori parameters of its description and starts at rest at the first
    position of the trajectory. Its controller is proportional-derivative, with an integral part on
    request (paper eq. 29, its sign corrected):

    \b
      tau = Kp (q_ref - q) + Kd (dq_ref - dq) + Ki integral(q_ref - q)

    where dq is the differentiated and smoothed reading of the encoder. Joints have viscous and
    Coulomb friction (eq. 2), and stick at rest. The motion is integrated by the Runge-Kutta method
    of fourth order.
    """
