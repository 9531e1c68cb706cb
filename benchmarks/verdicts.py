"""Whether the stated intervals and the verdict can be relied on: `make bench-verdicts`.

Every condition is simulated with the SCARA of the paper in its default control loop, with quick
moves (segments of 0.8 to 2 s), and identified as by `scarid identify --estimator wls --drop-slow
0.1 --align`. Conditions beyond noise, duration and method are made from the signals of the
simulated loop, sampled at 1 kHz: the logged torque is late, has an offset, Stribeck friction or
coloured noise, or the encoder is in front of a flexible joint. For each condition the table shows

- coverage: how often the 95 % intervals contain the true value [%],
- wrong: runs that are confidently wrong [%], which are graded good although an estimate is off by
  more than three of its stated errors,
- good: runs that are graded good [%],
- width: the median ratio of the intervals to those of leaving out blocks of time alone.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
from crossvalidation import FAST, seen
from defaults import PERIOD, RATIO, ROBOT, experiment

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.arrays import Array
from scarid_cli.io.table import Metadata, Table, doubles
from scarid_cli.stages.identify import identify

RECOMMENDED = Treatment(slow=(0.1, 0.1), align=True)
COLUMNS = [f"{signal}{i}" for signal in ("q", "dq", "ddq", "tau") for i in (1, 2)]
NOISE = np.array([joint.torque_noise for joint in ROBOT.joints])[:, None]  # N m
RESOLUTION = np.array([joint.encoder_resolution for joint in ROBOT.joints])[:, None]  # rad
COULOMB = np.array([ROBOT.value("coulomb", i) for i in (1, 2)])[:, None]  # N m
INERTIA = np.array([[3.42], [0.064]])  # kg m2, that a locked motor sees
H = PERIOD / RATIO  # s
Signals = tuple[Array, Array]  # logged positions [rad] and torques [N m] (joints, ticks)
Change = Callable[[LoopLog, np.random.Generator], Signals]


def as_logged(log: LoopLog, rng: np.random.Generator) -> Signals:  # noqa: ARG001
    """The log as it is."""
    return log.q, log.tau


def noisier(factor: float) -> Change:
    """So many times the torque noise."""
    return lambda log, rng: (
        log.q,
        log.tau + np.sqrt(factor**2 - 1.0) * NOISE * rng.standard_normal(log.tau.shape),
    )


def late(samples: int) -> Change:
    """The torque is late by so many samples of the log."""
    ticks = samples * RATIO

    def change(log: LoopLog, rng: np.random.Generator) -> Signals:  # noqa: ARG001
        return log.q[:, ticks:], log.tau[:, : log.tau.shape[1] - ticks]

    return change


def offset(part: float) -> Change:
    """The logged torque has an offset of this part of the Coulomb friction."""
    return lambda log, rng: (log.q, log.tau + part * COULOMB)  # noqa: ARG005


def stribeck(part: float, velocity: float) -> Change:
    """Friction at rest is larger than Coulomb friction, by this part of it, up to a velocity."""

    def change(log: LoopLog, rng: np.random.Generator) -> Signals:  # noqa: ARG001
        v = log.dq_true
        return log.q, log.tau + part * COULOMB * np.sign(v) * np.exp(-((v / velocity) ** 2))

    return change


def flexible(frequency: float) -> Change:
    """The encoders are on the motors; with them locked, the links vibrate at this frequency."""
    stiffness = INERTIA * (2.0 * np.pi * frequency) ** 2

    def change(log: LoopLog, rng: np.random.Generator) -> Signals:  # noqa: ARG001
        W = ROBOT.regressor(log.q_true, log.dq_true, log.ddq_true)
        motors = log.q_true + ROBOT.torques(W, ROBOT.apriori) / stiffness
        return np.round(motors / RESOLUTION) * RESOLUTION, log.tau

    return change


def coloured(factor: float, time: float) -> Change:
    """Noise of so many times the torque noise in 200 Hz, with this correlation time [s]."""

    def change(log: LoopLog, rng: np.random.Generator) -> Signals:
        keep = np.exp(-H / time)
        shocks = np.sqrt(1.0 - keep**2) * rng.standard_normal(log.tau.shape)
        noise = np.empty_like(shocks)
        noise[:, 0] = rng.standard_normal(len(noise))
        for k in range(1, noise.shape[1]):
            noise[:, k] = keep * noise[:, k - 1] + shocks[:, k]
        return log.q, log.tau + factor * NOISE * noise

    return change


@dataclass(frozen=True)
class Condition:
    """How a log comes about, and which soft sensor it passes."""

    name: str
    change: Change = as_logged
    method: str = "kalman"
    match: bool = True
    duration: float = 20.0


CAUSAL = ("kalman", "p2smd", "high-gain", "savgol-end", "ed-fir")
CONDITIONS = [
    Condition("clean"),
    Condition("clean, 5 s", duration=5.0),
    Condition("clean, 120 s", duration=120.0),
    Condition("noise x4", noisier(4.0)),
    *[Condition(f"{m} unmatched", method=m, match=False) for m in CAUSAL],
    *[Condition(f"{m} unmatched, noise x4", noisier(4.0), m, match=False) for m in CAUSAL],
    *[Condition(f"torque late by {n} samples", late(n)) for n in (1, 2, 3, 4)],
    Condition("offset", offset(0.5)),
    Condition("Stribeck, up to 0.1 rad/s", stribeck(0.5, 0.1)),
    Condition("Stribeck, up to 0.3 rad/s", stribeck(0.5, 0.3)),
    *[Condition(f"flexible joint {f} Hz", flexible(f)) for f in (15.0, 8.0)],
    *[Condition(f"coloured over {t} s", coloured(1.0, t)) for t in (0.5, 1.0, 2.0)],
    *[Condition(f"{m}, 120 s", method=m, duration=120.0) for m in CAUSAL[1:4]],
]


def motion(condition: Condition, seed: int) -> Table:
    """The motion of an experiment of this condition."""
    rng = np.random.default_rng((seed, 14))
    log = experiment(seed, FAST, duration=condition.duration)
    q, tau = (np.ascontiguousarray(x[:, ::RATIO]) for x in condition.change(log, rng))
    method = _method(condition.method)
    found = seen(method, q, tau, match=condition.match)
    signals = np.concatenate(found.signals)[:, found.settled]
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in signals], COLUMNS)
    return Table("motion", batch.schema, Metadata(kind="motion", period=PERIOD), iter([batch]))


def _method(name: str) -> Any:
    method = DIFFERENTIATORS.load(name)
    return method(**method.PRESETS["table1"] if name == "p2smd" else {})


@dataclass(frozen=True)
class Run:
    """The estimates of one run, their errors and intervals, and the metadata."""

    estimates: Array
    errors: Array
    low: Array
    high: Array
    extra: dict[str, Any]

    @property
    def good(self) -> bool:
        return bool(self.extra["verdict"] == "good")

    @property
    def off(self) -> Array:
        """How far the estimates are off, in stated errors."""
        return np.asarray(np.abs(self.estimates - ROBOT.apriori) / self.errors)


def identified(table: Table, estimator: str = "wls", treatment: Treatment = RECOMMENDED) -> Run:
    """The run of an estimator on a motion."""
    solver = ESTIMATORS.load(estimator)()
    found = identify(table, ROBOT, solver, np.zeros(8), treatment=treatment)
    (batch,) = found.batches
    names = ("estimate", "robust_error", "low", "high")
    columns = (batch.column(n).to_numpy(zero_copy_only=False) for n in names)
    return Run(*columns, found.meta.extra)


def row(condition: Condition, seeds: range) -> str:
    """The line of a condition in the table."""
    runs = [identified(motion(condition, seed)) for seed in seeds]
    truth = ROBOT.apriori
    inside = np.mean([(r.low <= truth) & (truth <= r.high) for r in runs])
    wrong = np.mean([r.good and np.any(r.off > 3.0) for r in runs])
    good = np.mean([r.good for r in runs])
    width = np.median([r.extra["widened"] for r in runs])
    return (
        f"{condition.name:36}{100.0 * inside:9.1f}{100.0 * wrong:7.0f}{100.0 * good:7.0f}"
        f"{width:8.2f}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=100, help="number of experiments")
    parser.add_argument("--seed", type=int, default=20_000, help="seed of the first experiment")
    parser.add_argument("--only", default="", help="only conditions whose name contains this")
    given = parser.parse_args()
    print(f"{'':36}{'coverage':>9}{'wrong':>7}{'good':>7}{'width':>8}")
    for condition in CONDITIONS:
        if given.only in condition.name:
            print(row(condition, range(given.seed, given.seed + given.runs)), flush=True)


if __name__ == "__main__":
    main()
