"""Online identification of simulated experiments, cross-validated: `make crossvalidate`.

The robot, the control loop and the trajectories are those of `scarid trajgen` and `scarid simulate`
with their defaults: 16-bit encoder, 200 Hz, 20 s, and no filter before the soft sensor. Parameters
are identified by recursive least squares with P0 = 100 and forgetting factor 1, and their torques
predicted for another experiment: from the motion that the same method estimates there, and from a
common one (a matched zero-phase Butterworth filter at 8 Hz).
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from defaults import PERIOD, RATIO, ROBOT, experiment
from matched import SettledMotion, motion

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.regression.rows import plain
from scarid_cli.arrays import Array

Experiment = tuple[Array, Array]  # positions [rad] and torques [N m], each (joints, rows)
FAST = (0.8, 2.0)  # s, duration of a segment
COMMON = DIFFERENTIATORS.load("zero-phase")(cutoff=8.0)
METHODS: list[tuple[str, str, dict[str, float]]] = [
    ("kalman", "default", {}),
    ("p2smd", "Table 1", DIFFERENTIATORS.load("p2smd").PRESETS["table1"]),
    ("p2smd", "default", {}),
    ("ed-fir", "Table 1", {}),
    ("2smd", "default", {}),
    ("levant", "default", {}),
    ("savgol-end", "default", {}),
    ("kalman-lag", "default", {}),
    ("rts", "default", {}),
]


def log(seed: int) -> Experiment:
    """Positions and torques of an experiment at the rate of the log."""
    run = experiment(seed, FAST)
    return np.ascontiguousarray(run.q[:, ::RATIO]), np.ascontiguousarray(run.tau[:, ::RATIO])


def seen(method: Any, q: Array, tau: Array, *, match: bool = True) -> SettledMotion:
    """The motion that the method estimates from a log."""
    fitted = [method.fitted(x, PERIOD) for x in q]
    if match:
        return motion(fitted, q, tau, PERIOD)
    derivatives = (over(m, x, PERIOD) for m, x in zip(fitted, q, strict=True))
    dq, ddq = (np.array(rows) for rows in zip(*derivatives, strict=True))
    return SettledMotion((q, dq, ddq, tau), np.ones(q.shape[1], dtype=bool))


def settled(motion: SettledMotion) -> list[Array]:
    return [np.ascontiguousarray(signal[:, motion.settled]) for signal in motion.signals]


def identified(motion: SettledMotion) -> Array:
    """Estimates by recursive least squares."""
    *kinematics, tau = settled(motion)
    rls = ESTIMATORS.load("rls")()
    W = ROBOT.regressor(*kinematics)
    state, _ = rls.step(rls.init(np.zeros(8)), plain(W, np.ascontiguousarray(tau.T)))
    estimates: Array = rls.fit(state).fit.estimates
    return estimates


def r2(motion: SettledMotion, theta: Array) -> list[float]:
    """Coefficient of determination of the predicted torques, for each joint."""
    *kinematics, tau = settled(motion)
    predicted = ROBOT.torques(ROBOT.regressor(*kinematics), theta)
    return [
        1.0 - float(np.sum((y - p) ** 2) / np.sum((y - y.mean()) ** 2))
        for y, p in zip(tau, predicted, strict=True)
    ]


def judged(method: Any, pair: tuple[Experiment, Experiment], *, match: bool = True) -> list[float]:
    """R2 of both joints on the method's own and on the common motion; three errors.

    The errors are those of ZZ1R, ZZ2 and L1MX2, relative to their true values [%].
    """
    own, other = pair
    theta = identified(seen(method, *own, match=match))
    at = [ROBOT.names.index(name) for name in ("ZZ1R", "ZZ2", "L1MX2")]
    errors = 100.0 * np.abs(theta[at] / ROBOT.apriori[at] - 1.0)
    through = r2(seen(method, *other, match=match), theta)
    return [*through, *r2(seen(COMMON, *other), theta), *errors]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="number of pairs of experiments")
    seeds = parser.parse_args().seeds
    pairs = [(log(2 * seed + 1), log(2 * seed + 2)) for seed in range(seeds)]
    print(f"Medians over {seeds} pairs of experiments; a dash (-) marks unmatched signals")
    print(f"{'':22}{'own motion':>16}{'common motion':>17}{'error of parameters [%]':>28}")
    print(f"{'':22}{'R2 1':>8}{'R2 2':>8}{'R2 1':>9}{'R2 2':>8}{'ZZ1R':>10}{'ZZ2':>9}{'L1MX2':>9}")
    for name, label, settings in METHODS:
        method = DIFFERENTIATORS.load(name)(**settings)
        for match in (True, False):
            rows = [judged(method, pair, match=match) for pair in pairs]
            a, b, c, d, e, f, g = np.median(rows, axis=0)
            quality = f"{a:8.4f}{b:8.4f}{c:9.4f}{d:8.4f}"
            print(
                f"{name:11}{label:8}{'' if match else ' -':3}{quality}  {e:8.2f} {f:8.2f} {g:8.2f}"
            )


if __name__ == "__main__":
    main()
