"""scarid identify"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.algorithms.registry import ESTIMATORS
from scarid_cli.cli import options


@click.command(name="identify")
@options.table_input
@options.robot
@click.option(
    "--estimator",
    type=click.Choice(ESTIMATORS.names),
    default="rls",
    show_default=True,
    help="ls: least squares; rls: recursive least squares.",
)
@click.option("--forgetting", type=float, help="Forgetting factor of rls per sample.  [default: 1]")
@click.option("--p0", type=float, help="Initial covariance of rls, P0 = p0 I.  [default: 100]")
@click.option(
    "--initial",
    metavar="FILE",
    help="Initial parameters of rls: a parameter table, or `apriori`.  [default: zeros]",
)
@click.option(
    "--unit-variance",
    is_flag=True,
    help="Standard errors for a residual variance of 1 (eq. 32-33) instead of the measured one.",
)
@click.option("--trace", metavar="FILE", help="Write the estimates after every sample (rls).")
@options.table_output
@options.common
def command(
    file: str,
    robot: str | None,
    estimator: str,
    forgetting: float | None,
    p0: float | None,
    initial: str | None,
    unit_variance: bool,
    trace: str | None,
    **rest: Any,
) -> None:
    """Estimate a robot's dynamic parameters from a motion.

    \b
      scarid identify motion.csv
      scarid identify --estimator ls --robot emps motion.parquet
      scarid identify --forgetting 0.999 --trace trace.parquet motion.csv

    Solves tau = W(q, dq, ddq) theta (paper eq. 25) for the robot's regressor W. rls is recursive
    least squares (section 2.3) in square-root form; ls is least squares by streaming orthogonal
    factorisation. Each estimate comes with its standard error s (diag (W'W)^-1)^1/2, where s^2 is
    the variance of the residual, and its relative standard deviation (eq. 34). Residuals of a
    sampled robot are autocorrelated: take these as lower bounds.
    """
    import numpy as np

    from scarid_cli.cli.job import job
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import identify as stage
    from scarid_cli.stages.validate import estimates

    given = {"forgetting": forgetting, "p0": p0}
    settings = {name: value for name, value in given.items() if value is not None}
    method = ESTIMATORS.load(estimator)
    if not method.RECURSIVE and (settings or initial or trace):
        raise UsageFault(
            f"--forgetting, --p0, --initial and --trace belong to rls, not to {estimator}"
        )
    solver = method(**settings)
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        side = run.output(trace) if trace else None
        table, arm = run.read_for(file, "motion", robot, torques=True)
        if initial == "apriori":
            start = arm.apriori
        elif initial:
            start = estimates(run.read(initial, "parameters"), arm)
        else:
            start = np.zeros(len(arm.parameters))
        result = stage.identify(
            run.recorded(table), arm, solver, start, unit_variance=unit_variance, trace=side
        )
        run.write(result, out)
        extra = result.meta.extra
        run.say(
            f"{arm.name}, {extra['samples']} samples, condition number of W "
            f"{extra['condition_number']:.4g}"
        )
