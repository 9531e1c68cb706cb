"""Motions with known derivatives, and what encoders make of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from defaults import PERIOD, RATIO, experiment

from scarid_cli.algorithms.excitations.quintic import Excitation
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

H = PERIOD
SECONDS = 20.0
INNER = slice(200, -200)  # a second at both ends is not judged


@dataclass(frozen=True)
class Run:
    """A motion of twenty seconds at 200 Hz: position, velocity, acceleration."""

    name: str
    q: Array
    v: Array
    a: Array


def runs() -> list[Run]:
    """Two of each kind."""
    return [make(seed) for make in (quintic, fourier, scara) for seed in (1, 2)]


def quintic(seed: int) -> Run:
    """Point to point in 1 to 3 s."""
    limits = Limits(*np.array([[-1.2], [1.2], [4.0], [20.0]]))
    rng = np.random.default_rng(seed)
    path = Excitation(1.0, 3.0).trajectory(limits, limits.home, SECONDS, rng)
    q, v, a = (row[0] for row in path.sample(np.arange(round(SECONDS / H)) * H))
    return Run(f"quintic {seed}", q, v, a)


def fourier(seed: int) -> Run:
    """Five harmonics of 0.1 Hz with amplitudes that fall."""
    rng = np.random.default_rng(100 + seed)
    t = np.arange(round(SECONDS / H)) * H
    q, v, a = np.zeros((3, len(t)))
    for k in range(1, 6):
        w, phase, size = 0.2 * np.pi * k, rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.2, 0.6) / k
        q += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    return Run(f"Fourier {seed}", q, v, a)


def scara(seed: int) -> Run:
    """One joint of the simulated robot, friction and all."""
    log = experiment(seed, (1.0, 3.0))
    joint = seed % 2
    signals = (log.q_true, log.dq_true, log.ddq_true)
    rows = round(SECONDS / H)
    q, v, a = (np.ascontiguousarray(x[joint, ::RATIO][:rows]) for x in signals)
    return Run(f"SCARA {seed}", q, v, a)


def seen(q: Array, bits: int, seed: int) -> Array:
    """Quantised, with white noise of a third of a step before."""
    step = 2.0 * np.pi / 2**bits
    noise = step / 3.0 * np.random.default_rng(seed).standard_normal(len(q))
    return step * np.round((q + noise) / step)


def glitched(q: Array, at: int) -> Array:
    """One sample off by 0.1 rad."""
    wrong = q.copy()
    wrong[at] += 0.1
    return wrong


def shaken(q: Array) -> Array:
    """10 mrad at 70 Hz."""
    return q + 0.01 * np.sin(2.0 * np.pi * 70.0 * np.arange(len(q)) * H)


def errors(v: Array, a: Array, run: Run) -> tuple[float, float]:
    """NRMSE of velocity and acceleration: root-mean-square error over deviation of the truth."""
    pairs = ((v, run.v), (a, run.a))
    found = [float(np.sqrt(np.mean((x - y)[INNER] ** 2)) / np.std(y[INNER])) for x, y in pairs]
    return found[0], found[1]
