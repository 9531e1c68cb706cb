"""The blind procedure on many robots under many conditions: `make gauntlet`.

    python benchmarks/gauntlet.py --seeds 5
    python benchmarks/gauntlet.py --robots scara2 --conditions clean,offset --seeds 20

Each robot follows random trajectories in its control loop, with one condition (an imperfection, a
rate, a duration) at a time. *Blind* is `scarid identify --robot R LOG` with nothing set, *default*
`scarid differentiate LOG | scarid identify` as it was before rows were left out and joints were
weighted, and *hindsight* the best of all cut-offs. Errors are those of the predicted torque: the
true regressor of another trajectory times the error of the estimates, relative to the torque, as a
mean over the joints. The columns of the table are

- blind: the median error [%]; / one, / hindsight, / default: its ratio, as geometric means, to the
  one cut-off that is best for all logs of the row, to the best one of each log, and to the default,
- coverage: the intervals that contain the true value [%],
- wrong: runs that are graded good although an estimate is off by more than three stated errors [%]
  (with more than eight parameters, by as many errors as are as unlikely for one of them),
- good: runs that are graded good [%],
- width: the median ratio of the stated errors to those of leaving out blocks of time alone.

Constants of the procedure were chosen with seeds below 1000; the default seeds judge.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pyarrow as pa
from arms import URDFS, described

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS, EXCITATIONS
from scarid_cli.algorithms.estimators import rls, wls
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.imperfections import PlantImperfections
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.plants.model import dynamics, model
from scarid_cli.algorithms.regression.counting import Counting
from scarid_cli.algorithms.regression.rows import joined
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.algorithms.sensors import building
from scarid_cli.algorithms.statistics.alignment import aligned
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.tuning.equivalent import chain
from scarid_cli.arrays import Array
from scarid_cli.cli.imperfections import imperfections
from scarid_cli.errors import ScaridError
from scarid_cli.io.table import Metadata, Table, matrix
from scarid_cli.stages.differentiate import matched
from scarid_cli.stages.identify import identify
from scarid_cli.stages.recommended import motion_of
from scarid_cli.stages.resample import resample
from scarid_cli.stages.rows import treated
from scarid_cli.stages.simulate import simulate
from scarid_cli.stages.trajgen import tabulate

ROBOTS = ("scara2", "planar2-gravity", "ur10", "panda")
CUTOFFS = 2.0 ** np.arange(0.0, 5.5, 0.5)  # Hz, tried in hindsight
HIGHEST = 0.2  # of the rate of the log, the last of them
REFERENCE = 100.0  # Hz, of the trajectories
CONTROL = 1000.0  # Hz
FLEXIBLE, CONSTANTS = "flexible joint", "motor constant"
Given = dict[str, tuple[float, ...]]


@dataclass(frozen=True)
class Condition:
    """What is not ideal: imperfections by name, in the units of the robot or of `simulate --with`.

    Those in `relative` are multiplied by the Coulomb friction of a joint, or by its torque noise.
    """

    name: str
    given: Given = field(default_factory=dict)
    relative: dict[str, tuple[str, float]] = field(default_factory=dict)
    rate: float = 200.0  # Hz
    duration: float = 20.0  # s


def _friction(name: str, imperfection: str, share: float, **more: tuple[float, ...]) -> Condition:
    given = {key.replace("_", "-"): value for key, value in more.items()}
    return Condition(name, given, {imperfection: ("coulomb", share)})


def _noise(name: str, imperfection: str, factor: float, **more: tuple[float, ...]) -> Condition:
    given = {key.replace("_", "-"): value for key, value in more.items()}
    return Condition(name, given, {imperfection: ("noise", factor)})


CONDITIONS = [
    Condition("clean"),
    *[Condition(f"{bits} bit", {"encoder-bits": (bits,)}) for bits in (12, 14, 20)],
    *[Condition(f"{rate:g} Hz", rate=rate) for rate in (100.0, 500.0, 1000.0)],
    *[Condition(f"{time:g} s", duration=time) for time in (5.0, 120.0)],
    _noise("torque noise x4", "torque-noise", 4.0),
    *[Condition(f"torque {n} samples late", {"torque-delay": (n * 0.005,)}) for n in (1, 2, 3, 4)],
    _friction("torque offset", "torque-offset", 0.5),
    _friction("Stribeck friction", "stribeck", 0.5, stribeck_velocity=(0.1,)),
    Condition("load friction", {"load-friction": (0.02,)}),
    *[Condition(f"{FLEXIBLE} {f} Hz", {"flexibility": (f,)}) for f in (8.0, 15.0)],
    *[
        Condition(
            f"base vibrates at {f:g} Hz",
            {
                "vibration": (0.5,),
                "vibration-frequency": (f,),
                "vibration-direction": (1.0, 1.0, 1.0),
            },
        )
        for f in (6.0, 12.0, 25.0)
    ],
    *[
        _noise(f"noise over {t:g} s", "coloured-torque-noise", 1.0, torque_noise_time=(t,))
        for t in (0.5, 2.0)
    ],
    _friction("torque ripple", "ripple", 0.2, ripple_cycles=(10.0,)),
    Condition("drive low-pass 50 Hz", {"drive-bandwidth": (50.0,)}),
    Condition("logged torque behind 30 Hz", {"torque-bandwidth": (30.0,)}),
    _friction("torque outliers", "torque-outlier-size", 2.0, torque_outliers=(0.002,)),
    Condition("lost rows", {"lost-rows": (0.01,)}),
    Condition("held samples", {"repeated-rows": (0.02,)}),
    Condition("standstill", {"standstill-before": (5.0,), "standstill-after": (5.0,)}),
    Condition(f"{CONSTANTS} 1 % off", {"torque-constant-error": (0.01,)}),
]


@cache
def robot_named(name: str) -> Robot:
    """A robot by its name; an arm known by its URDF gets motors and friction."""
    if not (URDFS / f"{name}.urdf").exists():
        return load(name)
    with tempfile.TemporaryDirectory() as folder:
        return load(str(described(URDFS / f"{name}.urdf", Path(folder))))


def trajectory(robot: Robot, seed: int, duration: float) -> Table:
    """A random trajectory within the limits of the robot."""
    limits = Limits.of(robot.joints)
    rng = np.random.default_rng(seed)
    motion = EXCITATIONS.load("quintic")().trajectory(limits, limits.home, duration, rng)
    meta = Metadata(kind="trajectory", robot=robot.name, period=1.0 / REFERENCE)
    return tabulate(motion, robot, REFERENCE, meta)


def log(robot: Robot, condition: Condition, seed: int) -> Table:
    """The simulated measurement, at a constant rate."""
    joints = len(robot.joints)
    sizes = {
        "coulomb": tuple(abs(robot.value("coulomb", i + 1)) for i in range(joints)),
        "noise": tuple(joint.torque_noise for joint in robot.joints),
    }
    relative = {
        name: tuple(factor * size for size in sizes[unit])
        for name, (unit, factor) in condition.relative.items()
    }
    words = (
        f"{name}={','.join(f'{x}' for x in value)}"
        for name, value in {**condition.given, **relative}.items()
    )
    known = imperfections(tuple(words), {}, robot.imperfections, joints)
    loop = ClosedLoop(
        robot=robot,
        law=law(robot, None, None, kp=None, kd=None, ki=None),
        seed=seed,
        control_rate=CONTROL,
        substeps=2,
        **building.in_the_loop(known, robot.joints, CONTROL),
    )
    table = simulate(
        trajectory(robot, seed, condition.duration), loop, condition.rate, truth=False, given=known
    )
    if {"lost-rows"} & set(condition.given):
        table = resample(table, condition.rate)
    return replace(table, batches=list(table.batches))  # type: ignore[arg-type]


def again(table: Table) -> Table:
    """A held table, to be read once more."""
    return replace(table, batches=iter(list(table.batches)))


@cache
def regressor(name: str, seed: int) -> Array:
    """The true regressor of another trajectory, ten rows a second."""
    robot = robot_named(name)
    batch = pa.Table.from_batches(list(trajectory(robot, seed + 10**6, 30.0).batches))
    columns = [f"{s}{i}" for s in ("q", "dq", "ddq") for i in range(1, len(robot.joints) + 1)]
    columns = [c if c in batch.column_names else f"{c}_ref" for c in columns]
    (whole,) = batch.combine_chunks().to_batches()
    motion = matrix(whole, columns)[:, ::10].reshape(3, len(robot.joints), -1)
    return robot.regressor(*(np.ascontiguousarray(x) for x in motion))


def truth_of(robot: Robot, condition: Condition) -> Array:
    """The true parameters, with what the condition adds to those that the robot has.

    These are the offset of the torques, and the inertia of a motor behind a flexible joint where
    that of the description is a part of the link's inertia.
    """
    unit, factor = condition.relative.get("torque-offset", ("coulomb", 0.0))
    truth = robot.apriori.copy()
    for i, parameter in enumerate(robot.parameters):
        if parameter.term.NAME == "offset":
            truth[i] += factor * abs(robot.value(unit, parameter.term.joints[0]))
        if "flexibility" in condition.given:
            parts = dict(parameter.parts)
            truth[i] += sum(parts.get(name, 0.0) * x for name, x in added_motors(robot).items())
    return truth


def added_motors(robot: Robot) -> dict[str, float]:
    """The inertia [kg m2] of motors that a flexible joint gets, by the name of its parameter."""
    arm = model(robot)
    own = np.diag(arm.motors)
    _, matrix = dynamics(arm, Limits.of(robot.joints).home)
    shares = np.where(own > 0.0, 0.0, PlantImperfections().motor_share * (np.diag(matrix) - own))
    return {f"Ia{i}": float(x) for i, x in enumerate(shares, start=1)}


def torque_error(name: str, truth: Array, seed: int, estimates: Array) -> float:
    """The error of the predicted torque, relative to the torque: a mean over the joints."""
    W = regressor(name, seed)
    off, torque = (np.sqrt(np.mean((W @ x) ** 2, axis=0)) for x in (estimates - truth, truth))
    return float(np.mean(off / torque))


@dataclass(frozen=True)
class Run:
    """What one log gives: torque errors, and how the blind procedure judges itself."""

    blind: float
    hindsight: tuple[float, ...]  # of each cut-off; inf where it leaves too few rows
    default: float
    inside: float
    wrong: bool
    good: bool
    width: float


def run(name: str, condition: Condition, seed: int) -> Run:
    """One log of a robot under a condition."""
    robot = robot_named(name)
    measured, truth = log(robot, condition, seed), truth_of(robot, condition)
    motion, found, _ = motion_of(again(measured), robot, lambda: None, [])
    treatment = Treatment(counting=_counting(motion), align=True)
    solver = ESTIMATORS.load("wls")()
    result = identify(motion, robot, solver, np.zeros(len(robot.names)), treatment=treatment)
    (batch,) = result.batches
    estimates, errors, low, high = (
        batch.column(c).to_numpy(zero_copy_only=False)
        for c in ("estimate", "robust_error", "low", "high")
    )
    known = np.isfinite(errors)
    off = np.abs(estimates - truth)[known] / errors[known]
    good = result.meta.extra["verdict"] == "good"
    off_by = partial(torque_error, name, truth, seed)
    return Run(
        blind=off_by(estimates),
        hindsight=tuple(
            np.inf if other is None else off_by(other)
            for other in hindsight(robot, measured, found.noise)
        ),
        default=off_by(default(robot, measured)),
        inside=float(np.mean((low <= truth)[known] & (truth <= high)[known])),
        wrong=bool(good and np.any(off > _many(len(truth)))),
        good=bool(good),
        width=float(result.meta.extra["widened"] or np.nan),
    )


def _many(parameters: int) -> float:
    """Standard errors that are exceeded as seldom as three by one of eight parameters."""
    normal = NormalDist()
    return -normal.inv_cdf(normal.cdf(-3.0) * min(1.0, 8.0 / parameters))


def _counting(motion: Table) -> Counting:
    extra = motion.meta.extra
    return Counting(extra.get("bandwidth"), tuple(extra.get("velocity_noise") or ()))


def hindsight(robot: Robot, measured: Table, noise: float) -> Iterator[Array | None]:
    """The estimates of all cut-offs; None where too few rows are left."""
    for cutoff in (f for f in CUTOFFS.tolist() if f < HIGHEST / measured.period):
        smoother = chain(DIFFERENTIATORS.load("rts")(), noise, cutoff, measured.period)
        motion = matched(again(measured), [smoother] * len(robot.joints), [])
        treatment = Treatment(counting=_counting(motion), align=True)
        try:
            parts = [rows for _, rows in treated(motion, robot, treatment)]
            rows, solver = joined(parts), wls.Estimator()
            found = aligned(solver.widened(), np.zeros(rows.W.shape[2] + 1), rows,
                            solver.of_rows(rows))  # fmt: skip
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


def line(name: str, condition: Condition, seeds: range) -> str:
    """The row of a robot and a condition."""
    runs = [run(name, condition, seed) for seed in seeds]

    def values(what: str) -> Array:
        return np.array([getattr(one, what) for one in runs], dtype=np.float64)

    cutoffs = np.log(values("hindsight"))  # (logs, cut-offs)
    blind = np.log(values("blind"))
    others = (cutoffs.mean(axis=0).min(), cutoffs.min(axis=1), np.log(values("default")))
    figures = [
        f"{100.0 * np.median(values('blind')):.2g}",
        *[f"{np.exp(np.mean(blind - other)):.2f}" for other in others],
        *[f"{100.0 * np.mean(values(what)):.0f}" for what in ("inside", "wrong", "good")],
        f"{np.median(values('width')):.2f}",
    ]
    return f"| {name} | {condition.name} | {' | '.join(figures)} |"


def cells(robots: list[str], conditions: list[str]) -> Iterator[tuple[str, Condition]]:
    """The robots that are here, each with the conditions that were asked for."""
    for name in robots:
        if name in ("ur10", "panda") and not URDFS.exists():
            continue
        rigid = not any(p.term.NAME == "mass" for p in robot_named(name).parameters)
        for condition in CONDITIONS:
            if rigid and condition.name.startswith(FLEXIBLE):
                continue  # a flexible joint has an inertia of its motor, for which there is no term
            if not conditions or any(part in condition.name for part in conditions):
                yield name, condition


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--conditions", default="", help="parts of their names, with commas")
    parser.add_argument("--seeds", type=int, default=5, help="number of logs of each")
    parser.add_argument("--seed", type=int, default=30_000, help="seed of the first log")
    given = parser.parse_args()
    seeds = range(given.seed, given.seed + given.seeds)
    chosen = list(cells(given.robots.split(","), [c for c in given.conditions.split(",") if c]))
    print(
        "| robot | condition | blind | / one | / hindsight | / default | coverage | wrong | good "
        "| width |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    with ProcessPoolExecutor(2) as pool:
        for row in pool.map(partial(_cell, seeds=seeds), chosen):
            print(row, flush=True)


def _cell(cell: tuple[str, Condition], seeds: range) -> str:
    return line(*cell, seeds)


if __name__ == "__main__":
    main()
