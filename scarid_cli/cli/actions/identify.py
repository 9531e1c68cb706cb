"""Run `scarid identify`."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import PHENOMENA
from scarid_cli.algorithms.checks.finding import WARNING, Finding
from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.choices.settings import names_of
from scarid_cli.algorithms.inference.verdict import meets
from scarid_cli.algorithms.regression.estimation import BaseEstimator
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.arrays import Array
from scarid_cli.cli.declaring.pairs import require_known, single_settings
from scarid_cli.cli.running.board import Board
from scarid_cli.cli.running.job import Job
from scarid_cli.cli.running.logs import read_logs
from scarid_cli.cli.running.measured import read, searching, tell_of
from scarid_cli.cli.running.terminal import is_terminal
from scarid_cli.cli.running.treatment import (
    behind_low_pass,
    for_robot,
    lead,
    report,
    treatment_of,
)
from scarid_cli.cli.running.watching import watcher
from scarid_cli.errors import OK, REQUIRED, UsageFault
from scarid_cli.interval import plus_minus
from scarid_cli.io.table import Table
from scarid_cli.io.writer import Document
from scarid_cli.stages.identify import SoFar
from scarid_cli.stages.procedure import blind
from scarid_cli.stages.procedure.blind import FOR_MOTION, Choices, Chosen, Prepared
from scarid_cli.stages.procedure.free import Anchor, freed
from scarid_cli.stages.records.corrected import corrected, correction, gains_of, told_gains
from scarid_cli.stages.results.documents import identification
from scarid_cli.stages.results.parameters import identified
from scarid_cli.stages.results.possible import require_bodies

CLEAR = 3.0  # standard errors, from which on torques lag behind the motion


def run(
    job: Job,
    *,
    files: tuple[str, ...],
    robot: str | None,
    variance: str,
    require: str | None,
    as_json: bool,
    **given: Any,
) -> int:
    """Write the parameters, and report the verdict; returns the exit status."""
    return shown(
        job,
        None,
        files=files,
        robot=robot,
        variance=variance,
        require=require,
        as_json=as_json,
        **given,
    )


def shown(
    job: Job,
    board: Board | None,
    *,
    files: tuple[str, ...],
    robot: str | None,
    variance: str,
    require: str | None,
    as_json: bool,
    **given: Any,
) -> int:
    """The same, with a board that shows what is known after each batch of rows."""
    choices = _choices(given)
    side, place = job.side_table(given["trace"]), job.side_text(given["save"])
    reading = partial(_read, job, choices.of_motion().method)
    logs, arm = read_logs(job, files, robot, reading, skip=given["skip"])
    arm, treatment = for_robot(arm, choices.treatment, given)
    if treatment.consistent:
        require_bodies(arm)
    settings = {**choices.settings, **_single(given["forgetting"], arm.names)}
    choices = replace(choices, treatment=treatment)
    if given["gains"]:
        logs, choices = _corrected(job, given["gains"], logs, arm, choices)
    prepared = blind.prepared(logs, arm, choices, progress=searching(job))
    chosen = prepared.chosen
    if board and (prepared.smoothed or chosen.treatment.holds):
        raise UsageFault(
            "watch shows estimates row by row, and the input is a measurement: let `scarid "
            "differentiate` estimate its velocities and accelerations before"
        )
    tell_of(job, prepared, logs, _options(chosen))
    if treatment.choose_friction and not chosen.treatment.align:
        raise UsageFault(
            "--friction auto needs the delay of the torques: give --align, and an estimator that "
            "has it"
        )
    start = _initial(job, given["initial"], arm)
    solver = chosen.method(**settings)
    untold = list[int]()
    if given["free_gains"]:
        anchor = Anchor.of(given["free_gains"], _common(treatment), len(arm.joints))
        found = freed(prepared, arm, settings, start, anchor)
        prepared, untold = found.prepared, found.untold
    fixed = _fixed(prepared, arm, solver, given["smooth_sign"])
    places: list[Checkpoint] = []
    findings: list[Finding] = []
    result = blind.estimated(
        replace(prepared, motion=job.recorded(prepared.motion)),
        arm,
        settings,
        start,
        variance=variance,
        trace=side,
        checkpoint=_restored(given["resumed"], fixed, solver, arm),
        keep=places.append,
        findings=findings,
        watch=_watch(job, arm, board),
    )
    document = partial(identification, estimator=chosen.name) if as_json else None
    job.write_or_print(result, document)
    if place:
        _save(place, places[0], fixed)
    for finding in findings:
        if finding.status == WARNING:
            job.say(f"warning: {finding.text}")
    _tell_of_gains(job, result, untold)
    _tell(job, prepared.motion, arm.name, chosen, result.meta.extra)
    return _status(job, require, result.meta.extra)


def _watch(job: Job, arm: Robot, board: Board | None) -> Callable[[SoFar], None] | None:
    """What shows the estimates so far, if somebody watches."""
    if board:
        return board.watched(arm)
    return watcher(job, arm.names) if is_terminal(2) else None


def _choices(given: dict[str, Any]) -> Choices:
    """What the options choose; refuses what is impossible before anything is read."""
    name = given["estimator"] or FOR_MOTION
    method = ESTIMATORS.load(name)
    values = _settings(method, name, given)
    method(**values)
    asked = Chosen(name, method, treatment_of(given))
    _require_possible(asked, given)
    one_by_one = any(given[option] for option in ("trace", "resumed", "save"))
    for_rows = one_by_one or given["forgetting"] or given["initial"]
    return Choices(
        estimator=name if for_rows else given["estimator"],
        settings=values,
        align=asked.treatment.align if one_by_one else given["align"],
        treatment=asked.treatment,
        bandwidth=given["bandwidth"],
        all_rows=given["all_rows"],
    )


def _corrected(
    job: Job, file: str, logs: list[Table], arm: Robot, choices: Choices
) -> tuple[list[Table], Choices]:
    """The logs with corrected torques; the intervals then allow for the errors of the gains."""
    found = correction(job.read(file, "gains"), len(arm.joints), _common(choices.treatment))
    treatment = replace(choices.treatment, gain_errors=found.errors)
    made = [corrected(log, found.gains.tolist()) for log in logs]
    return made, replace(choices, treatment=treatment)


def _common(treatment: Treatment) -> float:
    """The error of all torque constants that was stated."""
    return treatment.gain_errors if isinstance(treatment.gain_errors, float) else 0.0


def _tell_of_gains(job: Job, result: Table, untold: list[int]) -> None:
    """Say by which gains the torques were divided."""
    if gains := gains_of(result):
        job.say(f"torques are divided by the gains of their joints: {told_gains(gains)}")
    if untold:
        joints = ", ".join(str(j + 1) for j in untold)
        job.say(
            f"the log does not tell the gain of joint {joints}, taken as 1; --torque-gain-error "
            "states how well it is known"
        )


def _save(place: Document, checkpoint: Checkpoint, fixed: dict[str, Any]) -> None:
    """Write what --from continues from."""
    from scarid_cli.stages.results.continuation import saved  # zipfile takes a while to import

    place.write(saved(checkpoint, fixed))


def _tell(job: Job, table: Table, robot: str, chosen: Chosen, extra: dict[str, Any]) -> None:
    """Say which rows were left out, what was found, and the verdict on it."""
    report(job, table, chosen.treatment.counting, extra.get("left_out", {}))
    if told := chosen_friction(extra):
        job.say(told)
    facts, verdict = summary_lines(robot, chosen.name, extra)
    job.say(facts)
    job.say(verdict, extra["verdict"])


def _status(job: Job, require: str | None, extra: dict[str, Any]) -> int:
    """The exit status, which tells whether the verdict is what was required."""
    if not require or meets(require, extra["verdict"], biased=extra["biased"]):
        return OK
    job.demand(f"the verdict is {extra['verdict']}, which is worse than --require {require}")
    return REQUIRED


def _read(job: Job, method: Any, file: str, robot: str | Robot | None) -> tuple[Table, Robot]:
    """The motion or measurement, or whatever else the estimator reads, and the robot."""
    if method.FOLLOWS:
        return job.read_for(file, "trajectory", robot, torques=True, reference=method.REFERENCE)
    log, arm = read(job, file, robot, reference=method.REFERENCE)
    return blind.needed(log, reference=method.REFERENCE), arm


def _options(chosen: Chosen) -> list[str]:
    """What is used with a measurement and has to be stated for a motion."""
    return [f"--estimator {chosen.name}", *(["--align"] if chosen.treatment.align else [])]


def _restored(
    resumed: str | None, fixed: dict[str, Any], solver: BaseEstimator, arm: Robot
) -> Checkpoint | None:
    """The checkpoint to continue from, if one was given."""
    if not resumed:
        return None
    from scarid_cli.stages.results.continuation import restored  # zipfile takes a while to import

    return restored(resumed, fixed, solver, arm)


def _require_possible(asked: Chosen, given: dict[str, Any]) -> None:
    """Refuse options that the estimator, or the treatment of the rows, does not allow."""
    name, method, treatment = asked.name, asked.method, asked.treatment
    if given["trace"] and not method.RECURSIVE:
        raise UsageFault(f"--trace: {name} has no estimates after every sample; use rls or ekf")
    if given["gains"] and given["free_gains"]:
        raise UsageFault("--free-gains finds the gains that --gains states; give one of them")
    if given["free_gains"] and (method.FOLLOWS or given["trace"] or given["save"]):
        raise UsageFault(
            "--free-gains needs all rows twice, with velocities and accelerations; leave out "
            "--trace, --save and didim"
        )
    if treatment.align and not method.ALIGNS:
        raise UsageFault(f"--align cannot be combined with --estimator {name}")
    row_by_row = given["save"] or given["resumed"] or given["trace"]
    if row_by_row and (treatment.holds or method.HOLDS):
        what = f"--estimator {name}" if method.HOLDS else "--decimate or --align"
        raise UsageFault(
            f"--save, --from and --trace work row by row and cannot be combined with {what}"
        )
    if given["initial"] and not method.INITIAL:
        raise UsageFault(f"--initial: {name} has no initial parameters; leave the option out")


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
    prepared: Prepared, arm: Robot, solver: BaseEstimator, sign: float | None
) -> dict[str, Any]:
    """What must stay the same when a saved estimation is continued, as JSON holds it."""
    chosen = prepared.chosen
    known = {name: getattr(solver, name) for name in names_of(solver)}
    return {
        "robot": arm.name,
        "estimator": chosen.name,
        "period": prepared.motion.meta.period,
        "settings": json.loads(json.dumps(known)),
        "slow": list(chosen.treatment.slow),
        "smooth_sign": sign,
        **({"gains": gains} if (gains := gains_of(prepared.motion)) else {}),
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


def _th(number: int) -> str:
    return "2nd" if number == 2 else f"{number}th"


def summary_lines(robot: str, estimator: str, extra: dict[str, Any]) -> tuple[str, str]:
    """A line of facts, and the verdict."""
    line = f"{robot}, {estimator}, {extra['samples']} samples"
    if thin := extra.get("thinned"):
        every = extra.get("every_part")
        parts = f", of every {_th(every)} part of the log" if every else ""
        line += f" (every {_th(thin)} fitted{parts})"
    if extra.get("whitened"):
        line += ", whitened, as the residuals are correlated in time"
    if "delay" in extra:
        line += f", {_led(extra)}"
    if "dropped" in extra:
        names = ", ".join(extra["dropped"])
        line += f", dropped {names} (residual {100 * extra['dropped_cost']:.2g} % greater)"
    if "durbin_wu_hausman" in extra:
        line += f", Durbin-Wu-Hausman p {extra['durbin_wu_hausman']['p_value']:.2g}"
    return line, f"{extra['verdict']}: {'; '.join(extra['reasons'])}"


def chosen_friction(extra: dict[str, Any]) -> str:
    """What friction was worth fitting beside that of the robot, and what was not; or nothing."""
    if (found := extra.get("friction")) is None:
        return ""
    parts = [
        f"{PHENOMENA[x['name']].FRICTION} of joint {x['joint']} ({x['lower']:.2g} +- "
        f"{x['half_interval']:.2g} %)"
        for x in found
    ]
    kept = [part for part, x in zip(parts, found, strict=True) if x["kept"]]
    rest = [part for part, x in zip(parts, found, strict=True) if not x["kept"]]
    told = ", ".join(kept) or "none beside that of the robot"
    line = f"friction, by how much it lowers the error of parts that were left out: {told}"
    return f"{line}; not worth it: {', '.join(rest)}" if rest else line


def _led(extra: dict[str, Any]) -> str:
    """By what time the torques lead the motion, and what the cause may be."""
    delay, error = extra["delay"], extra["delay_error"]
    if delay is None:
        return (
            "torques taken as in step with the motion, because the log does not show a delay "
            "(--no-align if there is none)"
        )
    text = f"{lead(delay)} ({'error unknown' if error is None else plus_minus(1e3 * error)})"
    text += behind_low_pass(delay) if extra["low_pass"] else ""
    if error is not None and delay < -CLEAR * error:
        text += ", as if logged late, or as if the positions were commands"
    return text
