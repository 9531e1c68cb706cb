"""The blind procedure on many robots under many conditions: `make gauntlet`.

    python benchmarks/gauntlet.py --seeds 5
    python benchmarks/gauntlet.py --robots scara2 --conditions clean,offset --seeds 20
    python benchmarks/gauntlet.py --unseen --seeds 5 --further 95

Each robot follows random trajectories in its control loop, with one condition (an imperfection, a
rate, a duration) at a time. *Blind* is `scarid identify --robot R LOG` with nothing set, *default*
`scarid differentiate LOG | scarid identify` as it was before rows were left out and joints were
weighted, and *hindsight* the best of all cut-offs, by `wls` with a delay and nothing else: a
reference that remains the same when the procedure changes. Errors are those of the predicted
torque: the true regressor of another trajectory times the error of the estimates, relative to the
torque, as a mean over the joints. The columns of the table are

- blind: the median error [%]; / one, / hindsight, / default: its ratio, as geometric means, to the
  one cut-off that is best for all logs of the row, to the best one of each log, and to the default,
- coverage: the intervals that contain the true value [%],
- wrong: runs that are graded good although an estimate is off by more than three stated errors [%]
  (with more than eight parameters, by as many errors as are as unlikely for one of them),
- good: runs that are graded good [%],
- width: the median ratio of the stated errors to those of leaving out blocks of time alone.

The ratios are those of `--seeds` logs. As a share of 5 % takes many more logs to see, `--further`
ones are identified by the blind procedure alone, for the other columns.

Constants of the procedure were chosen with seeds below 1000; the default seeds judge.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, partial
from statistics import NormalDist

import numpy as np
import pyarrow as pa
from arms import URDFS
from conditions import (
    CONDITIONS,
    FLEXIBLE,
    UNSEEN,
    Condition,
    log,
    robot_named,
    trajectory,
    truth_of,
)

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.estimators import rls, wls
from scarid_cli.algorithms.inference.alignment import aligned
from scarid_cli.algorithms.regression.rows import joined, regressed
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.equivalent import chain
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, ScaridError
from scarid_cli.io.table import Table, matrix
from scarid_cli.stages.differentiate import matched
from scarid_cli.stages.identify import identify
from scarid_cli.stages.procedure.blind import Choices, counted, estimated, evened, prepared
from scarid_cli.stages.records.rows import treated

ARMS = ("ur10", "panda", "xarm7", "so101")  # whose URDFs are not in the repository
ROBOTS = ("scara2", "planar2-gravity", "ur10", "panda")
CUTOFFS = 2.0 ** np.arange(0.0, 5.5, 0.5)  # Hz, tried in hindsight
HIGHEST = 0.2  # of the rate of the log, the last of them
OTHER = Condition("another trajectory", duration=30.0)  # on which torques are predicted


def again(table: Table) -> Table:
    """A held table, to be read once more."""
    return replace(table, batches=iter(list(table.batches)))


@cache
def regressor(name: str, seed: int) -> Array:
    """The true regressor of another trajectory, ten rows a second."""
    robot = robot_named(name)
    batch = pa.Table.from_batches(list(trajectory(robot, seed + 10**6, OTHER).batches))
    columns = [f"{s}{i}" for s in ("q", "dq", "ddq") for i in range(1, len(robot.joints) + 1)]
    columns = [c if c in batch.column_names else f"{c}_ref" for c in columns]
    (whole,) = batch.combine_chunks().to_batches()
    motion = matrix(whole, columns)[:, ::10].reshape(3, len(robot.joints), -1)
    return robot.regressor(*(np.ascontiguousarray(x) for x in motion))


def torque_error(name: str, truth: Array, seed: int, estimates: Array) -> float:
    """The error of the predicted torque, relative to the torque: a mean over the joints."""
    W = regressor(name, seed)
    return relative_error(W @ (estimates - truth), W @ truth)


def relative_error(off: Array, torque: Array) -> float:
    """The root mean square of errors over that of torques (samples, joints), a mean over joints."""
    sizes, usual = (np.sqrt(np.mean(x**2, axis=0)) for x in (off, torque))
    return float(np.mean(sizes / usual))


@dataclass(frozen=True)
class Judged:
    """What the blind procedure finds in one log, and how it judges itself.

    `torque` is the error of the predicted torque, and `off` the errors of the estimates, of those
    whose errors are stated, in units of these. `inside` is the share of the intervals that contain
    the true value. `noise` [rad or m] is that of the positions.
    """

    torque: float
    off: Array
    inside: float
    wrong: bool
    good: bool
    width: float
    noise: float


def blind(name: str, measured: Table, gain_error: float = 0.0) -> tuple[Table, float]:
    """What `scarid identify --robot NAME LOG` finds, and the noise of the positions.

    `gain_error` is the relative error of the torque constants that is stated to it.
    """
    return blind_of(robot_named(name), measured, gain_error)


def blind_of(robot: Robot, measured: Table, gain_error: float = 0.0) -> tuple[Table, float]:
    """The same for this robot."""
    choices = Choices(treatment=Treatment(gain_errors=gain_error))
    found = prepared([again(measured)], robot, choices)
    noise = found.smoothed.noise if found.smoothed else 0.0
    return estimated(found, robot, choices.settings), noise


def judged(name: str, truth: Array, measured: Table, seed: int, gain_error: float = 0.0) -> Judged:
    """The blind procedure on a log of a robot with these parameters."""
    result, noise = blind(name, measured, gain_error)
    (batch,) = result.batches
    estimates, errors, low, high = (
        batch.column(c).to_numpy(zero_copy_only=False)
        for c in ("estimate", "robust_error", "low", "high")
    )
    known = np.isfinite(errors)
    off = (estimates - truth)[known] / errors[known]
    good = result.meta.extra["verdict"] == "good"
    return Judged(
        torque=torque_error(name, truth, seed, estimates),
        off=off,
        inside=float(np.mean((low <= truth)[known] & (truth <= high)[known])),
        wrong=bool(good and np.any(np.abs(off) > _many(len(truth)))),
        good=bool(good),
        width=float(result.meta.extra["widened"] or np.nan),
        noise=noise,
    )


@dataclass(frozen=True)
class Run:
    """A log: what the blind procedure finds, and the torque errors of others."""

    blind: Judged
    hindsight: tuple[float, ...]  # of each cut-off; inf where it leaves too few rows
    default: float


def alone(name: str, condition: Condition, seed: int) -> Judged:
    """What the blind procedure finds in one log of a robot under a condition."""
    robot = robot_named(name)
    measured, truth = log(robot, condition, seed), truth_of(robot, condition)
    return judged(name, truth, measured, seed, condition.gain_error)


def run(name: str, condition: Condition, seed: int) -> Run:
    """The same, and what others find."""
    robot = robot_named(name)
    measured, truth = log(robot, condition, seed), truth_of(robot, condition)
    found = judged(name, truth, measured, seed, condition.gain_error)
    off_by = partial(torque_error, name, truth, seed)
    measured = replace(even := evened(again(measured))[0], batches=list(even.batches))
    others = hindsight(robot, measured, found.noise)
    return Run(
        blind=found,
        hindsight=tuple(np.inf if other is None else off_by(other) for other in others),
        default=off_by(default(robot, measured)),
    )


def _many(parameters: int) -> float:
    """Standard errors that are exceeded as seldom as three by one of eight parameters."""
    normal = NormalDist()
    return -normal.inv_cdf(normal.cdf(-3.0) * min(1.0, 8.0 / parameters))


def hindsight(robot: Robot, measured: Table, noise: float) -> Iterator[Array | None]:
    """The estimates of all cut-offs; None where too few rows are left."""
    for cutoff in (f for f in CUTOFFS.tolist() if f < HIGHEST / measured.period):
        smoother = chain(DIFFERENTIATORS.load("rts")(), noise, cutoff, measured.period)
        motion = matched(again(measured), [smoother] * len(robot.joints), [])
        treatment = Treatment(counting=counted(motion.meta, None), align=True)
        try:
            parts = [rows for _, rows in treated(motion, robot, treatment)]
            rows, solver = regressed(joined(parts), robot), wls.Estimator()
            start = np.zeros(rows.W.shape[2] + 1)
            first = solver.of_rows(rows).fit.estimates
            found = aligned(solver, start, rows, first, len(robot.parameters))
        except (ScaridError, ValueError):
            yield None
            continue
        yield found.found.fit.estimates[: len(robot.names)]


def default(robot: Robot, measured: Table) -> Array:
    """The estimates of what was the default before."""
    kalman = DIFFERENTIATORS.load("kalman")()
    motion = matched(again(measured), [kalman] * len(robot.joints))
    solver = rls.Estimator(weights=0)
    result = identify(motion, robot, solver, np.zeros(len(robot.names)), treatment=Treatment())
    (batch,) = result.batches
    estimates: Array = batch.column("estimate").to_numpy(zero_copy_only=False)
    return estimates


def line(name: str, condition: Condition, seeds: range, further: int = 0) -> str:
    """The row of a robot and a condition, with so many further logs for the blind procedure."""
    runs = [run(name, condition, seed) for seed in seeds]
    more = range(seeds.stop, seeds.stop + further)
    logs = [one.blind for one in runs] + [alone(name, condition, seed) for seed in more]

    def values(what: str) -> Array:
        return np.array([getattr(one, what) for one in logs], dtype=np.float64)

    cutoffs = np.log([one.hindsight for one in runs])  # (logs, cut-offs)
    blind, default = (np.log(x) for x in (values("torque"), [one.default for one in runs]))
    others = (cutoffs.mean(axis=0).min(), cutoffs.min(axis=1), default)
    figures = [
        f"{100.0 * np.median(values('torque')):.2g}",
        *[f"{np.exp(np.mean(blind[: len(runs)] - other)):.2f}" for other in others],
        *[f"{100.0 * np.mean(values(what)):.0f}" for what in ("inside", "wrong", "good")],
        f"{np.median(values('width')):.2f}",
    ]
    return f"| {name} | {condition.name} | {' | '.join(figures)} |"


def cells(
    robots: list[str], known: list[Condition], chosen: list[str]
) -> Iterator[tuple[str, Condition]]:
    """The robots that are here, each with the known conditions that were asked for."""
    for name in robots:
        if name in ARMS and not URDFS.exists():
            continue
        rigid = not any(p.term.NAME == "mass" for p in robot_named(name).parameters)
        for condition in known:
            if rigid and condition.name.startswith(FLEXIBLE):
                continue  # a flexible joint has an inertia of its motor, for which there is no term
            if not chosen or any(part in condition.name for part in chosen):
                yield name, condition


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--conditions", default="", help="parts of their names, with commas")
    parser.add_argument("--unseen", action="store_true", help="the conditions of the second table")
    parser.add_argument("--seeds", type=int, default=5, help="number of logs of each")
    parser.add_argument("--further", type=int, default=0, help="more logs, blind alone")
    parser.add_argument("--seed", type=int, default=30_000, help="seed of the first log")
    given = parser.parse_args()
    seeds = range(given.seed, given.seed + given.seeds)
    names = [c for c in given.conditions.split(",") if c]
    chosen = list(cells(given.robots.split(","), UNSEEN if given.unseen else CONDITIONS, names))
    print(
        "| robot | condition | blind | / one | / hindsight | / default | coverage | wrong | good "
        "| width |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    with ProcessPoolExecutor(2) as pool:
        row_of = partial(_cell, seeds=seeds, further=given.further)
        for row in pool.map(row_of, chosen):
            print(row, flush=True)


def _cell(cell: tuple[str, Condition], seeds: range, further: int) -> str:
    try:
        return line(*cell, seeds, further)
    except BadData as refusal:
        return f"| {cell[0]} | {cell[1].name} | refused: {refusal} |"


if __name__ == "__main__":
    main()
