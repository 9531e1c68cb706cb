"""scarid identify"""

from __future__ import annotations

from typing import Any

import click

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.cli import options
from scarid_cli.cli.described import describing


@click.command(name="identify", cls=describing(ESTIMATORS, "Estimators and their settings"))
@options.table_input
@options.robot
@click.option(
    "--estimator",
    type=click.Choice(ESTIMATORS.names),
    default="rls",
    show_default=True,
    help="How; see below.",
)
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    help="A setting of the estimator; repeatable.",
)
@click.option(
    "--forgetting",
    metavar="FACTOR[,NAME=FACTOR...]",
    help="Forgetting factor of rls per sample; after it, those of single parameters.  [default: 1]",
)
@click.option("--p0", type=float, help="Initial covariance of rls, P0 = p0 I.  [default: 100]")
@click.option(
    "--initial",
    metavar="FILE",
    help="Initial parameters of rls or ekf: a parameter table, or `apriori`.  [default: zeros]",
)
@options.treatment
@click.option(
    "--align",
    is_flag=True,
    help="Fit the time by which the torques lead the motion as well. Holds the whole log.",
)
@click.option(
    "--essential",
    is_flag=True,
    help="Drop the worst known parameter while its relative deviation is 30 times the best one's.",
)
@click.option(
    "--variance",
    type=click.Choice(("residual", "unit", "sample")),
    default="residual",
    show_default=True,
    help="Of the residual, for standard_error: with r - c degrees of freedom, 1 as printed in eq. "
    "32-33, or with r - 1.",
)
@click.option("--trace", metavar="FILE", help="Write the estimates after every sample (rls, ekf).")
@click.option("--from", "resumed", metavar="STATE", help="Go on from where --save left off.")
@click.option("--save", metavar="STATE", help="Save where the estimation is (.npz).")
@options.table_output
@options.common
def command(
    file: str,
    robot: str | None,
    estimator: str,
    initial: str | None,
    variance: str,
    trace: str | None,
    resumed: str | None,
    save: str | None,
    **rest: Any,
) -> None:
    """Estimate a robot's dynamic parameters from a motion, and say whether to believe them.

    \b
      scarid identify motion.csv
      scarid identify --estimator wls --drop-slow 0.1 --align motion.csv
      scarid identify --estimator ls --robot emps --skip 49 --decimate 10 motion.parquet
      scarid identify --forgetting 0.999,Fv1=0.99 --trace trace.parquet motion.csv
      scarid identify --save state.npz monday.csv; scarid identify --from state.npz tuesday.csv

    Solves tau = W(q, dq, ddq) theta (paper eq. 25) for the robot's regressor W. Each estimate comes
    with the standard error of white residuals, s (diag (W'W)^-1)^1/2 (eq. 32-34), and with one that
    autocorrelated residuals cannot shrink, from leaving out blocks of half a second; low and high
    are its 95 % interval. The last line on standard error is the verdict: good, doubtful or not
    identifiable, and why.
    """
    import numpy as np

    from scarid_cli.cli.job import job
    from scarid_cli.cli.treatment import for_robot, treatment_of
    from scarid_cli.errors import UsageFault
    from scarid_cli.stages import identify as stage

    method = ESTIMATORS.load(estimator)
    given = _given(method, estimator, rest)
    method(**given)  # refuses settings before anything is read
    treatment = treatment_of(rest)
    if trace and not method.RECURSIVE:
        raise UsageFault(f"--trace: {estimator} has no estimates after every sample")
    if treatment.align and not method.ALIGNS:
        raise UsageFault(f"--align does not go with --estimator {estimator}")
    if (save or resumed or trace) and (treatment.holds or method.HOLDS):
        what = f"--estimator {estimator}" if method.HOLDS else "--decimate or --align"
        raise UsageFault(f"--save, --from and --trace go row by row; not with {what}")
    with job(rest) as run:
        out = run.output(rest["output"], rest["format"])
        side = run.output(trace) if trace else None
        place = run.text(save) if save else None
        table, arm = run.read_for(file, "motion", robot, torques=True)
        arm, treatment = for_robot(arm, treatment, rest)
        solver = method(**given, **_single(rest["forgetting"], arm.names))
        if initial == "apriori":
            start = arm.apriori
        elif initial:
            from scarid_cli.stages.parameters import identified

            start = identified(run.read(initial, "parameters"), arm).theta
        else:
            start = np.zeros(len(arm.parameters))
        told = {
            "robot": arm.name,
            "estimator": estimator,
            "period": table.meta.period,
            "settings": _told(solver),
            "slow": list(treatment.slow),
            "smooth_sign": rest["smooth_sign"],
        }
        checkpoint = None
        if resumed:
            from scarid_cli.stages.continuation import restored

            checkpoint = restored(resumed, told)
        places: list[Any] = []
        result = stage.identify(
            run.recorded(table),
            arm,
            solver,
            start,
            treatment=treatment,
            variance=variance,
            trace=side,
            checkpoint=checkpoint,
            keep=places.append,
        )
        run.write(result, out)
        if place:
            from scarid_cli.stages.continuation import saved

            place.write(saved(places[0], told))
        _say(run, arm.name, estimator, result.meta.extra)


def _given(method: Any, name: str, rest: dict[str, Any]) -> dict[str, Any]:
    """The settings that were given, which must be some of the estimator's."""
    from scarid_cli.cli.pairs import pair, require_known
    from scarid_cli.errors import UsageFault

    given: dict[str, Any] = {}
    for text in rest["settings"]:
        key, value = pair(text, "--set")
        try:
            given[key] = float(value)
        except ValueError:
            raise UsageFault(f"--set {text}: {value!r} is not a number") from None
    if rest["p0"] is not None:
        given["p0"] = rest["p0"]
    if rest["forgetting"] is not None:
        given["forgetting"] = _number(rest["forgetting"], rest["forgetting"].split(",")[0])
    known = names_of(method)
    for key in given:
        require_known(known, key, name)
    if "," in (rest["forgetting"] or ""):
        del given["forgetting"]  # of single parameters: these are known with the robot
    return given


def _single(text: str | None, names: list[str]) -> dict[str, tuple[float, ...]]:
    """`0.999,Fv1=0.99`: one forgetting factor for all, then those of single parameters."""
    from scarid_cli.errors import UsageFault

    if text is None or "," not in text:
        return {}
    first, *single = text.split(",")
    factors = dict.fromkeys(names, _number(text, first))
    for part in single:
        name, _, value = part.partition("=")
        if name not in factors:
            raise UsageFault(
                f"--forgetting {text}: no parameter {name!r}; there are {', '.join(names)}"
            )
        factors[name] = _number(text, value)
    return {"forgetting": tuple(factors.values())}


def _number(text: str, part: str) -> float:
    from scarid_cli.errors import UsageFault

    try:
        return float(part)
    except ValueError:
        raise UsageFault(
            f"--forgetting {text}: write a number, then NAME=NUMBER for single parameters"
        ) from None


def _told(solver: Any) -> dict[str, Any]:
    """The settings of an estimator that must not change when it goes on."""
    import json

    known = {name: getattr(solver, name) for name in names_of(solver)}
    settings: dict[str, Any] = json.loads(json.dumps(known))
    return settings


def _say(run: Any, robot: str, estimator: str, extra: dict[str, Any]) -> None:
    """One line of facts, then the verdict."""
    line = f"{robot}, {estimator}, {extra['samples']} samples"
    if "delay" in extra:
        delay, error = 1e3 * extra["delay"], 1e3 * extra["delay_error"]
        line += f", torques lead by {delay:.3g} ms (+- {error:.2g})"
    if "dropped" in extra:
        names = ", ".join(extra["dropped"])
        line += f", dropped {names} (residual {100 * extra['dropped_cost']:.2g} % greater)"
    if "durbin_wu_hausman" in extra:
        line += f", Durbin-Wu-Hausman p {extra['durbin_wu_hausman']['p_value']:.2g}"
    run.say(line)
    run.say(f"{extra['verdict']}: {'; '.join(extra['reasons'])}")
