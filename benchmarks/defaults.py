"""The measurements behind the defaults, on the simulated robot; see docs/design/signals.md."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.signal

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.excitations.quintic import Excitation
from scarid_cli.algorithms.filters.butterworth import Butterworth
from scarid_cli.algorithms.plants.controllers import law
from scarid_cli.algorithms.plants.loop import ClosedLoop
from scarid_cli.algorithms.robots import reading
from scarid_cli.algorithms.sensors.signals import LoopLog
from scarid_cli.algorithms.trajectories.hermite import refine
from scarid_cli.algorithms.trajectories.limits import Limits

ROBOT = reading.load("scara2")
PERIOD, RATIO = 0.005, 5
SEEDS = (1, 3, 5)
SETTINGS: list[tuple[str, str, dict[str, float]]] = [
    ("p2smd", "Table 1", DIFFERENTIATORS.load("p2smd").PRESETS["table1"]),
    ("p2smd", "default", {}),
    ("ed-fir", "Table 1", {}),
    ("2smd", "Table 1", DIFFERENTIATORS.load("2smd").PRESETS["table1"]),
    ("2smd", "default", {}),
    ("astd", "Table 1", DIFFERENTIATORS.load("astd").PRESETS["table1"]),
    ("astd", "gamma 0.0015, k0m 0.01", {"gamma": 0.0015, "k0m": 0.01}),
    ("astd", "default", {}),
]


def experiment(
    seed: int, segment: tuple[float, float], cutoff: float = 20.0, duration: float = 20.0
) -> LoopLog:
    """So many seconds of the simulated robot in its default loop, at the control rate."""
    limits, rng = Limits.of(ROBOT.joints), np.random.default_rng(seed)
    path = Excitation(*segment).trajectory(limits, limits.home, duration, rng)
    instants = np.arange(round(duration / PERIOD) + 1) * PERIOD
    wanted = refine(*path.sample(instants), PERIOD, RATIO)
    loop = ClosedLoop(
        robot=ROBOT,
        law=replace(law(ROBOT), velocity_cutoff=cutoff),
        encoder_resolution=np.array([joint.encoder_resolution for joint in ROBOT.joints]),
        position_noise=np.zeros(2),
        torque_noise=np.array([joint.torque_noise for joint in ROBOT.joints]),
        seed=seed,
    )
    return loop.step(loop.init(wanted[0][:, 0]), *wanted)[1]


def errors(log: LoopLog, method: str, settings: dict[str, float]) -> list[tuple[float, float]]:
    """NRMSE of velocity and acceleration for each joint, without the first second."""
    found = []
    for joint in range(2):
        q = np.ascontiguousarray(log.q[joint, ::RATIO])
        lowpass = Butterworth(20.0)
        _, (q,) = lowpass.step(lowpass.init(q[0], PERIOD), q)
        differentiator = DIFFERENTIATORS.load(method)(**settings)
        _, estimates = differentiator.step(differentiator.init(q[0], PERIOD), q)
        truths = (log.dq_true[joint, ::RATIO], log.ddq_true[joint, ::RATIO])
        v, a = (
            float(np.sqrt(np.mean((x - y)[200:] ** 2)) / np.std(y))
            for x, y in zip(estimates, truths, strict=True)
        )
        found.append((v, a))
    return found


def lag(omega: float, settings: dict[str, float]) -> float:
    """Delay [s] of the acceleration of p2smd on sin(omega t), over the second half of it."""
    t = np.arange(round(20.0 * np.pi / omega / PERIOD)) * PERIOD
    method = DIFFERENTIATORS.load("p2smd")(**settings)
    _, (_, a) = method.step(method.init(0.0, PERIOD), np.sin(omega * t))
    half = len(t) // 2
    turns = np.exp(-1j * omega * t[half:])
    return float(
        -np.angle(np.sum(a[half:] * turns) / np.sum(-np.sin(omega * t[half:]) * turns)) / omega
    )


def main() -> None:
    fast = [experiment(seed, (0.8, 2.0)) for seed in SEEDS]
    slow = [experiment(seed, (2.0, 4.0)) for seed in SEEDS]
    print("NRMSE of velocity and acceleration: with segments of 0.8 to 2 s, and of 2 to 4 s")
    for method, name, settings in SETTINGS:
        row = [np.mean([errors(log, method, settings) for log in logs], axis=(0, 1))
               for logs in (fast, slow)]  # fmt: skip
        print(f"  {method:8} {name:24}" + "".join(f" {v:8.3f} {a:6.3f}" for v, a in row))
    print("\nAcceleration above 15 Hz, RMS of joints 1 and 2 [rad/s2], by cutoff of dq [Hz]")
    low = scipy.signal.butter(4, 15.0, fs=1.0 / PERIOD * RATIO, output="sos")
    for cutoff in (0.0, 50.0, 20.0):
        a = experiment(3, (0.8, 2.0), cutoff).ddq_true
        print(
            f"  {cutoff or 'none':>5}", (a - scipy.signal.sosfiltfilt(low, a)).std(axis=1).round(2)
        )
    print("\nStandard deviation of the torques of joints 1 and 2 [N m], seeds 0 to 5")
    stds = np.array([experiment(seed, (0.8, 2.0)).tau_true.std(axis=1) for seed in range(6)])
    print(f"  from {stds.min(axis=0).round(2)} to {stds.max(axis=0).round(2)}")
    print("\nDelay of the acceleration of p2smd on a sine [ms]: default, and without adaptation")
    for omega in (0.3, 1.0, 1.6, 3.0):
        lags = [1e3 * lag(omega, settings) for settings in ({}, {"cap": 1e-15})]
        print(f"  {omega:3} rad/s  {lags[0]:5.1f} {lags[1]:5.1f}")


if __name__ == "__main__":
    main()
