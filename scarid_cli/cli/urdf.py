"""scarid urdf"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.cli import options


@click.command(name="urdf")
@click.argument("robot", metavar="ROBOT")
@click.option(
    "--parameters",
    required=True,
    metavar="FILE",
    help="The parameter table of `scarid identify --robot ROBOT`; in Parquet or Arrow it carries "
    "the covariance of the estimates.",
)
@click.option(
    "--output", "-o", default="-", metavar="FILE", help="Write the URDF to FILE.  [default: stdout]"
)
@click.option(
    "--base", metavar="FILE", help="Write the base parameters of the new bodies as a table."
)
@click.option(
    "--motion",
    metavar="FILE",
    help="Report R2 per joint of this motion, before and after. Give the options below as to "
    "identify.",
)
@options.treatment
@options.common
def command(
    robot: str, parameters: str, output: str, base: str | None, motion: str | None, **rest: Any
) -> None:
    """Write identified parameters into a copy of a URDF as physically consistent link inertias.

    \b
      scarid urdf --parameters parameters.parquet arm.urdf -o identified.urdf
      scarid urdf --parameters p.parquet --motion motion.parquet arm.toml -o identified.urdf
      scarid urdf --parameters p.parquet --base near.csv arm.toml -o identified.urdf

    ROBOT is the URDF, or the TOML file that names it. Identified base parameters may belong to no
    real robot: a mass may come out negative, for example. This command computes physically
    consistent link inertias from them: positive masses and positive definite pseudo-inertias
    (Wensing, Kim, Slotine 2018), at the smallest Mahalanobis distance from the estimates. Of all
    such bodies it takes those closest to the bodies of the URDF. Parameters that `identify
    --essential` dropped stay at zero where positive masses allow it.

    The covariance of the estimates comes with a Parquet or Arrow table. CSV has none; the
    correlations are then neglected, which can ruin the prediction of torques: check with --motion.

    Viscous and Coulomb friction become damping and friction of the joints. What a URDF cannot hold
    (motor inertias, offsets, couplings) is in a comment. Needs the extra: pip install
    'scarid[urdf]'.
    """
    from pathlib import Path

    from scarid_cli.algorithms.robots.reading import load
    from scarid_cli.cli.job import command_line, job
    from scarid_cli.cli.treatment import for_robot, treatment_of
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import urdf as stage
    from scarid_cli.stages.estimates import estimates_with_covariance
    from scarid_cli.stages.rows import Treatment

    treatment = treatment_of(rest)
    if not motion and (treatment != Treatment() or rest["smooth_sign"]):
        raise UsageFault("options for the rows of a motion need --motion FILE")
    arm = load(robot)
    if not arm.body:
        raise UsageFault(f"{robot}: has no URDF to write parameters into")
    path = Path(arm.body.path)
    arm, treatment = for_robot(arm, treatment, rest)
    with job(rest) as run:
        out = run.text(output)
        side = run.output(base) if base else None
        table = run.read(parameters, "parameters")
        identified = estimates_with_covariance(table, arm)
        found = stage.physical(identified)
        for line in stage.consistency_report(identified, found):
            run.say(line)
        if motion:
            log, _ = run.read_for(motion, "motion", robot, torques=True)
            for line in stage.r2_report(
                *stage.r2_before_and_after(log, identified, found, treatment)
            ):
                run.say(line)
        out.write(stage.document(path.read_text("utf-8"), arm, found, command_line()))
        if side:
            run.write(run.recorded(stage.base_table(table, identified, found)), side)
