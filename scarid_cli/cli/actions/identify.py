"""Run `scarid identify`."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.checkpoint import Checkpoint
from scarid_cli.algorithms.statistics.verdict import meets
from scarid_cli.arrays import Array
from scarid_cli.cli.job import Job
from scarid_cli.cli.logs import read_logs
from scarid_cli.cli.measured import motion
from scarid_cli.cli.pairs import require_known, single_settings
from scarid_cli.cli.resampled import Resampled
from scarid_cli.cli.treatment import for_motion, for_robot, report, treatment_of
from scarid_cli.errors import OK, REQUIRED, UsageFault
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import Table
from scarid_cli.stages import identify as stage
from scarid_cli.stages.parameters import identified
from scarid_cli.stages.reach import Reach

ONLINE, OFFLINE = "rls", "wls"  # what a motion, and a measurement, are identified by


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    robot: str | None,
    estimator: str | None,
    initial: str | None,
    variance: str,
    trace: str | None,
    resumed: str | None,
    save: str | None,
    require: str | None,
    **given: Any,
) -> int:
    """Write the parameters, and report the verdict; returns the exit status."""
    name = estimator or ONLINE
    method = ESTIMATORS.load(name)
    values = _settings(method, name, given)
    method(**values)  # refuses settings before anything is read
    treatment = treatment_of(given)
    _require_possible(method, name, treatment, trace=trace, resumable=save or resumed)
    if initial and not method.INITIAL:
        raise UsageFault(f"--initial: {name} has no initial parameters; leave the option out")
    side, place = job.side_table(trace), job.side_text(save)
    resampled = Resampled(job)
    reading = partial(_read, job, method, resampled)
    table, arm = read_logs(job, files, robot, reading, skip=given["skip"])
    arm, treatment = for_robot(arm, treatment, given)
    if not method.FOLLOWS and not numbered(table.columns, "ddq"):
        row_by_row = bool(trace or resumed or save)
        if not (estimator or values or given["forgetting"] or initial or row_by_row):
            name, method = OFFLINE, ESTIMATORS.load(OFFLINE)
        if given["align"] is None and method.ALIGNS and not row_by_row:
            treatment = replace(treatment, align=True)
        table = motion(job, table, arm, _options(name, treatment), resampled.rates)
    given["all_rows"] |= method.FOLLOWS
    reach = Reach(len(arm.joints))
    table = reach.watched(table)
    treatment = for_motion(table.meta, treatment, given)
    solver = method(**values, **_single(given["forgetting"], arm.names))
    start = _initial(job, initial, arm)
    fixed = _fixed(table, arm, name, solver, treatment, given["smooth_sign"])
    places: list[Checkpoint] = []
    result = stage.identify(
        job.recorded(table),
        arm,
        solver,
        start,
        treatment=treatment,
        variance=variance,
        trace=side,
        checkpoint=_restored(resumed, fixed),
        keep=places.append,
    )
    job.write(result)
    if place:
        from scarid_cli.stages.continuation import saved

        place.write(saved(places[0], fixed))
    for remark in reach.remarks(arm, table.period):
        job.say(f"warning: {remark}")
    report(job, table, treatment.counting, result.meta.extra.get("left_out", {}))
    _tell(job, arm.name, name, result.meta.extra, aligned=treatment.align)
    return _status(job, require, result.meta.extra)


def _tell(job: Job, robot: str, name: str, extra: dict[str, Any], *, aligned: bool) -> None:
    """Say what was found, and the verdict on it."""
    facts, verdict = summary_lines(robot, name, extra)
    job.say(facts)
    job.say(verdict, extra["verdict"])
    if aligned and job.out.format == "csv":
        job.say("CSV does not keep the delay: write -o FILE.parquet for validate to apply it")


def _status(job: Job, require: str | None, extra: dict[str, Any]) -> int:
    """The exit status, which tells whether the verdict is what was required."""
    if not require or meets(require, extra["verdict"], extra["reasons"]):
        return OK
    job.say(f"the verdict is worse than --require {require}")
    return REQUIRED


def _read(
    job: Job, method: Any, resampled: Resampled, file: str, robot: str | Robot | None
) -> tuple[Table, Robot]:
    """The motion or measurement, or whatever else the estimator reads, and the robot."""
    table, arm = job.read_for(
        file,
        "trajectory" if method.FOLLOWS else "motion",
        robot,
        torques=True,
        reference=method.REFERENCE,
        without_derivatives=None if method.FOLLOWS else "measurement",
    )
    if method.FOLLOWS or numbered(table.columns, "ddq"):
        return table, arm
    return resampled.table(file, table), arm


def _options(name: str, treatment: Treatment) -> list[str]:
    """What is used with a measurement and has to be stated for a motion."""
    return [f"--estimator {name}", *(["--align"] if treatment.align else [])]


def _restored(resumed: str | None, fixed: dict[str, Any]) -> Checkpoint | None:
    """The checkpoint to continue from, if one was given."""
    if not resumed:
        return None
    from scarid_cli.stages.continuation import restored  # zipfile takes a while to import

    return restored(resumed, fixed)


def _require_possible(
    method: Any, name: str, treatment: Treatment, *, trace: str | None, resumable: str | None
) -> None:
    """Refuse options that the estimator, or the treatment of the rows, does not allow."""
    if trace and not method.RECURSIVE:
        raise UsageFault(f"--trace: {name} has no estimates after every sample; use rls or ekf")
    if treatment.align and not method.ALIGNS:
        raise UsageFault(f"--align cannot be combined with --estimator {name}")
    if (resumable or trace) and (treatment.holds or method.HOLDS):
        what = f"--estimator {name}" if method.HOLDS else "--decimate or --align"
        raise UsageFault(
            f"--save, --from and --trace work row by row and cannot be combined with {what}"
        )


def _initial(job: Job, initial: str | None, arm: Robot) -> Array:
    """The initial parameters: the a priori ones, those of a table, or zeros."""
    if initial == "apriori":
        return arm.apriori
    if initial:
        theta = identified(job.read(initial, "parameters"), arm).theta
        if len(theta) > len(arm.parameters):
            raise UsageFault(
                f"--initial: {initial} has friction that fades with speed (separable), which this "
                "estimator does not have; give the parameters of another estimator"
            )
        return theta
    return np.zeros(len(arm.parameters))


def _fixed(
    table: Table, arm: Robot, estimator: str, solver: Any, treatment: Treatment, sign: float | None
) -> dict[str, Any]:
    """What must stay the same when a saved estimation is continued, as JSON holds it."""
    known = {name: getattr(solver, name) for name in names_of(solver)}
    return {
        "robot": arm.name,
        "estimator": estimator,
        "period": table.meta.period,
        "settings": json.loads(json.dumps(known)),
        "slow": list(treatment.slow),
        "smooth_sign": sign,
    }


def _settings(method: Any, name: str, options: dict[str, Any]) -> dict[str, float]:
    """The settings that were given, which must be some of the estimator's."""
    known = names_of(method)
    given = single_settings(options["settings"], known, name)
    if options["p0"] is not None:
        given["p0"] = options["p0"]
    if options["forgetting"] is not None:
        given["forgetting"] = _number(options["forgetting"], options["forgetting"].split(",")[0])
    for key in given:
        require_known(known, key, name)
    if "," in (options["forgetting"] or ""):
        del given["forgetting"]  # of single parameters: these are known with the robot
    return given


def _single(text: str | None, names: list[str]) -> dict[str, tuple[float, ...]]:
    """`0.999,Fv1=0.99`: one forgetting factor for all, then those of single parameters."""
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
    try:
        return float(part)
    except ValueError:
        raise UsageFault(
            f"--forgetting {text}: write a number, then NAME=NUMBER for single parameters"
        ) from None


def summary_lines(robot: str, estimator: str, extra: dict[str, Any]) -> tuple[str, str]:
    """A line of facts, and the verdict."""
    line = f"{robot}, {estimator}, {extra['samples']} samples"
    if "delay" in extra:
        error = extra["delay_error"]
        known = "error unknown" if error is None else f"+- {1e3 * error:.2g}"
        line += f", torques lead by {1e3 * extra['delay']:.3g} ms ({known})"
    if "dropped" in extra:
        names = ", ".join(extra["dropped"])
        line += f", dropped {names} (residual {100 * extra['dropped_cost']:.2g} % greater)"
    if "durbin_wu_hausman" in extra:
        line += f", Durbin-Wu-Hausman p {extra['durbin_wu_hausman']['p_value']:.2g}"
    return line, f"{extra['verdict']}: {'; '.join(extra['reasons'])}"
