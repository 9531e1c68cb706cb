"""The figures of a differentiator on known motions: errors, delay, disturbances and cost."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from math import inf, nan
from typing import Any

import numpy as np
from signals import INNER, H, Sensor, TrueMotion, errors, glitched, seen, shaken

from scarid_cli.algorithms.processes.delays import lateness
from scarid_cli.arrays import Array

CLASSES = ("causal", "fixed lag", "whole record")
BATCH = 8192  # rows


@dataclass
class Score:
    """Figures of a method at one resolution, motion by motion, as differentiators.py says."""

    name: str
    kind: str
    bits: int
    ours: bool
    seeds: list[int] = field(default_factory=list)
    v: list[float] = field(default_factory=list)
    a: list[float] = field(default_factory=list)
    informed: list[float] = field(default_factory=list)
    delay: list[float] = field(default_factory=list)
    settling: list[float] = field(default_factory=list)
    glitch: list[float] = field(default_factory=list)
    vibration: list[float] = field(default_factory=list)
    rest: list[float] = field(default_factory=list)
    cost: float = nan

    @property
    def total(self) -> float:
        return 100.0 * geometric(np.sqrt(np.multiply(self.v, self.a)))

    @property
    def of_truth(self) -> float:
        return self.total / (100.0 * geometric(self.informed)) if self.informed else nan

    def measure(self, sensor: Sensor, motion: TrueMotion, seed: int) -> None:
        """Add the errors and the delay on one motion."""
        start = time.perf_counter()
        v, a = sensor(seen(motion.q, self.bits, seed))
        self.cost = (time.perf_counter() - start) / len(motion.q) * 1e9
        errors_v, errors_a = errors(v, a, motion)
        self.seeds.append(seed)
        self.v.append(errors_v)
        self.a.append(errors_a)
        self.delay.append(1e3 * lateness(a[INNER], motion.a[INNER], H))

    def disturb(self, sensor: Sensor, motion: TrueMotion, seed: int) -> None:
        """Add the response to a start in motion, a glitch, a vibration and a standstill."""
        q = seen(motion.q, self.bits, seed)
        v, a = sensor(q)
        self.settling.append(settling(sensor, q, motion))
        _, wrong = sensor(glitched(q, 2000))
        self.glitch.append(float(np.abs(wrong - a)[INNER].max()))
        _, trembling = sensor(seen(shaken(motion.q), self.bits, seed))
        self.vibration.append(errors(v, trembling, motion)[1])
        if seed == 0:
            stopped = np.concatenate((motion.q[:2000], np.full(10_000, motion.q[2000])))
            _, a = sensor(seen(stopped, self.bits, seed))
            self.rest.append(float(np.sqrt(np.mean(a[-2200:-200] ** 2))))


def settling(sensor: Sensor, q: Array, motion: TrueMotion) -> float:
    """Time [ms] until the velocity stays within a tenth of its deviation, started at top speed."""
    start = min(int(np.argmax(np.abs(motion.v))), len(q) - 800)
    first, _ = sensor(q[start : start + 800])
    off = np.abs(first - motion.v[start : start + 800]) > 0.1 * np.std(motion.v)
    return 1e3 * H * (int(np.flatnonzero(off)[-1]) + 1 if off.any() else 0)


def geometric(values: Any) -> float:
    """The geometric mean."""
    return float(np.exp(np.mean(np.log(values))))


def class_of(method: Any) -> str:
    """Causal, fixed lag or whole record."""
    lag = method.lag(H)
    return CLASSES[0] if lag == 0 else CLASSES[2] if lag == inf else CLASSES[1]


def cost(process: Any, q: Array) -> float:
    """Nanoseconds per sample, in batches as a stage runs it; the best of three."""
    long = np.tile(q, 10)
    best = inf
    for _ in range(3):
        start = time.perf_counter()
        state = process.init(long[0], H)
        for at in range(0, len(long), BATCH):
            state, _ = process.step(state, long[at : at + BATCH])
        process.finish(state)
        best = min(best, time.perf_counter() - start)
    return best / len(long) * 1e9
