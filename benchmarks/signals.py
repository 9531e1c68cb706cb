"""Motions with known derivatives, and their positions as encoders measure them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from defaults import PERIOD, RATIO, experiment

from scarid_cli.algorithms.excitations.quintic import Excitation
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

Derivatives = tuple[Array, Array]  # velocities and accelerations
Sensor = Callable[[Array], Derivatives]  # takes positions
H = PERIOD
SECONDS = 20.0
INNER = slice(200, -200)  # errors leave out a second at both ends


@dataclass(frozen=True)
class TrueMotion:
    """A motion of twenty seconds at 200 Hz: position [rad], velocity and acceleration."""

    name: str
    q: Array
    v: Array
    a: Array


def motions() -> list[TrueMotion]:
    """Two motions of each kind."""
    return [make(seed) for make in (quintic, fourier, scara) for seed in (1, 2)]


def quintic(seed: int) -> TrueMotion:
    """Point-to-point moves, each in 1 to 3 s."""
    limits = Limits(*np.array([[-1.2], [1.2], [4.0], [20.0]]))
    rng = np.random.default_rng(seed)
    path = Excitation(1.0, 3.0).trajectory(limits, limits.home, SECONDS, rng)
    q, v, a = (row[0] for row in path.sample(np.arange(round(SECONDS / H)) * H))
    return TrueMotion(f"quintic {seed}", q, v, a)


def fourier(seed: int) -> TrueMotion:
    """Five harmonics of 0.1 Hz with decreasing amplitudes."""
    rng = np.random.default_rng(100 + seed)
    t = np.arange(round(SECONDS / H)) * H
    q, v, a = np.zeros((3, len(t)))
    for k in range(1, 6):
        w, phase, size = 0.2 * np.pi * k, rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.2, 0.6) / k
        q += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    return TrueMotion(f"Fourier {seed}", q, v, a)


def scara(seed: int) -> TrueMotion:
    """One joint of the simulated robot, with its friction."""
    log = experiment(seed, (1.0, 3.0))
    joint = seed % 2
    signals = (log.q_true, log.dq_true, log.ddq_true)
    rows = round(SECONDS / H)
    q, v, a = (np.ascontiguousarray(x[joint, ::RATIO][:rows]) for x in signals)
    return TrueMotion(f"SCARA {seed}", q, v, a)


def seen(q: Array, bits: int, seed: int) -> Array:
    """The positions with white noise of a third of an encoder step, quantised."""
    step = 2.0 * np.pi / 2**bits
    noise = step / 3.0 * np.random.default_rng(seed).standard_normal(len(q))
    return step * np.round((q + noise) / step)


def glitched(q: Array, at: int) -> Array:
    """The positions with one sample off by 0.1 rad."""
    wrong = q.copy()
    wrong[at] += 0.1
    return wrong


def shaken(q: Array) -> Array:
    """The positions with a vibration of 10 mrad at 70 Hz."""
    return q + 0.01 * np.sin(2.0 * np.pi * 70.0 * np.arange(len(q)) * H)


def errors(v: Array, a: Array, motion: TrueMotion) -> tuple[float, float]:
    """NRMSE of velocity and acceleration: RMS error over the true standard deviation."""
    pairs = ((v, motion.v), (a, motion.a))
    found = [float(np.sqrt(np.mean((x - y)[INNER] ** 2)) / np.std(y[INNER])) for x, y in pairs]
    return found[0], found[1]
