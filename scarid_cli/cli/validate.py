"""scarid validate"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="validate")
@options.table_input
@click.option(
    "--parameters", required=True, metavar="FILE", help="The parameter table of `scarid identify`."
)
@options.robot
@options.treatment
@click.option("--predictions", metavar="FILE", help="Write measured and predicted torques.")
@options.table_output
@options.common
def command(
    file: str, parameters: str, robot: str | None, predictions: str | None, **rest: Any
) -> None:
    """Predict torques with identified parameters, and measure how well.

    \b
      scarid validate --parameters parameters.csv motion.csv
      scarid validate --parameters p.parquet --predictions torques.parquet motion.parquet

    Per joint: R2 (paper eq. 36), root-mean-square error (eq. 35), relative error 100 |tau -
    tau_hat| / |tau| in percent, number of samples. On the motion that the parameters were
    identified from this is direct validation; on another motion, cross validation. Rows are
    treated as by identify: give it the same options.
    """
    from scarid_cli.cli.job import job
    from scarid_cli.cli.treatment import for_robot, treatment_of
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import validate as stage
    from scarid_cli.stages.parameters import identified

    treatment = treatment_of(rest)
    if treatment.holds and predictions:
        raise UsageFault("--predictions are of every row; not with --decimate")
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        side = run.output(predictions) if predictions else None
        known = run.read(parameters, "parameters")
        table, arm = run.read_for(file, "motion", robot or known.meta.robot, torques=True)
        arm, treatment = for_robot(arm, treatment, rest)
        model = identified(known, arm)
        result = stage.validate(run.recorded(table), model, treatment=treatment, predictions=side)
        run.write(result, out)
        if model.delay:
            run.say(f"torques are predicted {1e3 * model.delay:.3g} ms early, as identified")
