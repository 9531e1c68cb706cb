"""The declaration of `scarid identify`."""

from __future__ import annotations

import click

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.cli.declaring import options, selecting
from scarid_cli.cli.declaring.declare import declare
from scarid_cli.cli.declaring.described import describing
from scarid_cli.cli.declaring.headings import DATA, ERRORS, METHOD, MODEL, OUTPUT, heading


@declare("identify", describing(ESTIMATORS, "Estimators"))
@options.table_inputs
@heading(DATA)
@options.robot
@selecting.selection
@heading(METHOD)
@click.option(
    "--estimator",
    type=click.Choice(ESTIMATORS.names),
    help="The estimator; see below.  [default: rls; gls for a measurement, unless --trace, "
    "--save, --from, --set, --initial or --forgetting is given]",
)
@options.settings_of("estimator")
@click.option(
    "--forgetting",
    metavar="FACTOR[,NAME=FACTOR...]",
    shell_complete=options.offered("parameters"),
    help="Forgetting factor of rls per sample, followed by other factors for single parameters.  "
    "[default: 1]",
)
@click.option(
    "--p0", type=options.NUMBER, help="Initial covariance of rls, P0 = p0 I.  [default: 100]"
)
@click.option(
    "--initial",
    type=options.InputFile("apriori"),
    metavar="FILE",
    help="Initial parameters of rls or ekf: a parameter table, or `apriori` for the a priori "
    "values of the robot.  [default: zeros]",
)
@options.treatment
@click.option(
    "--align/--no-align",
    default=None,
    help="Also fit the time by which the torques lead the motion. Holds the whole log in memory.  "
    "[default: --align for a measurement only]",
)
@options.input_file(
    "--from", "resumed", metavar="STATE", help="Continue the estimation that --save wrote."
)
@heading(MODEL)
@click.option(
    "--essential",
    is_flag=True,
    help="Keep only essential parameters: drop one after another, the least certain first, while "
    "its relative standard deviation is more than 30 times the smallest one and the fit gets no "
    "worse than noise explains.",
)
@click.option(
    "--friction",
    type=click.Choice(("described", "auto")),
    default="described",
    show_default=True,
    help="With auto, also fit friction that the robot has no term for, as far as it lowers the "
    "error of parts of the log that are left out of the fit: asymmetric, falling or curved with "
    "the speed, growing with the load, rippling with the position.",
)
@click.option(
    "--consistent",
    is_flag=True,
    help="Estimates that rigid bodies can have: those nearest to the free ones, in units of their "
    "errors, with positive masses and inertias, and with friction and motor inertias that are not "
    "negative. Intervals keep to that as well. Needs a URDF, and cvxpy (extra `urdf`).",
)
@heading(ERRORS)
@options.input_file("--gains", help="Divide the torques by the gains that `scarid gains` wrote.")
@click.option(
    "--free-gains",
    metavar="ANCHOR",
    help="Estimate the gain of each joint's torque as well, and divide the torques by them. ANCHOR "
    "fixes the factor that all have in common: the number of a joint, whose gain is 1; `masses`, "
    "those of the URDF; or `constants`, within --torque-gain-error.",
)
@click.option(
    "--torque-gain-error",
    metavar="PART",
    help="Standard error of the torque constants, such as 1% or 0.01. No log shows the factor that "
    "all have in common. It is added to the errors of the parameters; with --free-gains, it is "
    "what is known of each gain before the log.  [default: 0]",
)
@click.option(
    "--variance",
    type=click.Choice(("residual", "unit", "sample")),
    default="residual",
    show_default=True,
    help="Variance of the residual in the column standard_error: estimated with r - c degrees of "
    "freedom (residual), 1 as printed in paper eq. 32-33 (unit), or estimated with r - 1 (sample).",
)
@heading(OUTPUT)
@click.option(
    "--require",
    cls=options.Unrecorded,
    type=click.Choice(("good", "rough", "not-biased", "identifiable")),
    help="Exit with status 3 if the verdict is worse; the table is written all the same. A "
    "doubtful verdict is not-biased unless the soft sensor or a delay changes the estimates, or "
    "the log fails a check.",
)
@options.as_json
@options.side_output("--trace", help="Write the estimates after every sample (rls, ekf).")
@options.side_output(
    "--save",
    metavar="STATE",
    help="Write the state of the estimation (.npz), to be continued with --from.",
)
@options.table_output
@options.common
def command() -> None:
    """Estimate a robot's dynamic parameters from a motion, and judge their reliability.

    \b
      scarid identify --robot arm.toml log.csv
      scarid differentiate log.csv --format arrow | scarid identify --robot arm.toml
      scarid identify --estimator wls --drop-slow 0.1 --align motion.csv
      scarid identify --estimator ls --robot emps --skip 49 --decimate 10 motion.parquet
      scarid identify --forgetting 0.999,Fv1=0.99 --trace trace.parquet motion.csv
      scarid identify --robot arm.toml monday.parquet tuesday.parquet
      scarid identify --save state.npz monday.csv; scarid identify --from state.npz tuesday.csv

    A measurement, which has positions and torques but no derivatives, is identified by the whole
    recommended procedure in one process: the bandwidth is chosen as by `scarid tune --robot`,
    positions and torques of all joints pass a smoother of this bandwidth, and the parameters are
    estimated with --estimator gls --align. The pipe of two commands that gives the same parameters
    is reported. The measurement is held in memory.

    Several logs are segments of one estimation: all have the same robot, units and rate, nothing
    is filtered from one to the next, and a measurement gets one bandwidth and one delay for all.
    --from-time, --to-time and --rows apply to each of them.

    Solves tau = W(q, dq, ddq) theta (paper eq. 25), where W is the robot's regressor. Each estimate
    has two standard errors: one that holds for white residuals, s (diag (W'W)^-1)^1/2 (eq. 32-34),
    and a robust one, which also holds for autocorrelated residuals and allows for what the model
    may lack: it grows where the estimates would change with an offset or Stribeck friction, without
    the rows near reversals, or behind another low-pass. The columns low and high are the 95 %
    confidence interval from the robust error. The verdict (good, doubtful or not identifiable) and
    its reasons are on standard error, and in the metadata of the table.
    """
