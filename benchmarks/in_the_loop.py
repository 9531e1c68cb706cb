"""The paper's soft sensors in the loop: what they do to tracking, torques and parameters.

    python benchmarks/in_the_loop.py

The controller of paper eq. 29 takes the velocity of the soft sensor. The log of the loop is then
identified with velocities and accelerations of the same soft sensor (matched to the torques,
online, as in the paper), and by the recommended procedure. Errors are those of the torques of the
parameters, in percent of the true ones, on the motion of the log; the median over the seeds.
"""

from __future__ import annotations

import argparse

import numpy as np

import scarid
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.stages.simulate import SIGNALS

TABLE1 = ",preset=table1"  # of the paper
SENSORS = (
    "ed-fir",
    "2smd",
    f"2smd{TABLE1}",
    "astd",
    f"astd{TABLE1}",
    "p2smd",
    f"p2smd{TABLE1}",
    "kalman",
)
ROBOT = load("scara2")


def torque_error(found: scarid.Judged, log: scarid.Log) -> float:
    """The rms torque of the parameters' errors, in percent of that of the truth."""
    joints = range(1, len(ROBOT.joints) + 1)
    motion = (np.array([log[f"{name}{i}_true"] for i in joints]) for name in SIGNALS)
    W = ROBOT.regressor(*motion)
    estimates = np.array(list(found.estimates.values()))
    wrong, truth = W @ (estimates - ROBOT.apriori), W @ ROBOT.apriori
    return float(100.0 * np.sqrt(np.mean(np.mean(wrong**2, 0) / np.mean(truth**2, 0))))


def row(sensor: str, seeds: int) -> list[float]:
    """Tracking errors [mrad], changes of the torques [N m], errors online and offline [%]."""
    method, _, preset = sensor.partition(",preset=")
    found: list[list[float]] = []
    for seed in range(1, seeds + 1):
        reference = scarid.trajgen(seed=seed, robot="scara2")
        try:
            log = scarid.simulate(
                reference, seed=seed, control="pd", soft_sensor=sensor, truth=True
            )
        except scarid.BadData:
            found.append([np.nan] * 6)
            continue
        said = log.messages[-1].split("(rms): ")[1].replace(",", "").split()
        numbers = [float(x) for x in said if x[0].isdigit()]  # joint, error, change; twice
        online = scarid.identify(
            scarid.differentiate(log, method=method, preset=preset or None), robot="scara2"
        )
        offline = scarid.identify(log, robot="scara2")
        errors = [torque_error(one, log) for one in (online, offline)]
        found.append([1e3 * numbers[1], 1e3 * numbers[4], numbers[2], numbers[5], *errors])
    lost = int(np.isnan(found).any(axis=1).sum())
    return [*np.nanmedian(found, axis=0).tolist(), lost]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    given = parser.parse_args()
    print(
        "| soft sensor | tracking error, joints 1 and 2 [mrad] | change of torque from tick to tick"
        " [N m] | error online [%] | error offline [%] | loops lost |"
    )
    print("|---|---|---|---|---|---|")
    for sensor in SENSORS:
        a, b, c, d, on, off, lost = row(sensor, given.seeds)
        print(
            f"| `{sensor}` | {a:.2g}, {b:.2g} | {c:.2g}, {d:.2g} | {on:.2g} | {off:.2g} |"
            f" {lost} of {given.seeds} |"
        )


if __name__ == "__main__":
    main()
