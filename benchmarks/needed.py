"""The torques that a robot needs on another motion, where its model lacks a term.

    python benchmarks/needed.py --seeds 20

The gauntlet compares torques of the model alone. If a robot has more than its model, parameters
that make up for it are then called wrong. Here the prediction is compared with the true torque of
another log under the same condition, at the true motion: that of the blind procedure (`blind`, a
median in % of the torque, as a mean over the joints), with what it fitted beside the parameters,
and divided by that of the former default
(`/ default`, a geometric mean). `of the model` is the latter ratio as in the gauntlet.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np
from conditions import CONDITIONS, Condition, log, robot_named, truth_of
from gauntlet import blind, default, relative_error, torque_error

from scarid_cli.algorithms.regression.rows import Rows, rows_of
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.table import concatenated, matrix
from scarid_cli.stages.results.parameters import identified

ROBOTS = ("scara2", "planar2-gravity")
LACKING = ("load friction", "Stribeck friction", "cable pulls", "motor saturates")
STEP = 10  # samples between those that are compared


def needed(robot: Robot, condition: Condition, seed: int) -> Rows:
    """The rows of another motion, with its true derivatives and the torques that it takes."""
    joints = range(1, len(robot.joints) + 1)
    batches = log(robot, condition, seed + 10**6, truth=True).batches
    whole = concatenated(list(batches))
    t, q, dq, ddq, tau = (
        matrix(whole, ["t"] if symbol == "t" else [f"{symbol}{i}_true" for i in joints])
        for symbol in ("t", "q", "dq", "ddq", "tau")
    )
    if condition.altered:
        tau = condition.altered(robot, (t[0], q, tau))[2]
    motion = np.ascontiguousarray(np.stack((q, dq, ddq, tau))[:, :, ::STEP])
    return rows_of(robot, motion, np.arange(motion.shape[2]), STEP * float(t[0, 1] - t[0, 0]))


def errors(name: str, condition: Condition, seed: int) -> Array:
    """The errors of the blind procedure and of the default: of the needed, and of the model's."""
    robot = robot_named(name)
    measured, truth = log(robot, condition, seed), truth_of(robot, condition)
    rows = needed(robot, condition, seed)
    model = identified(blind(name, measured)[0], robot)
    found = []
    for one in (model, replace(model, theta=default(robot, measured), additions=())):
        needs = relative_error(one.torques(rows).T - rows.y, rows.y)
        found.append((needs, torque_error(name, truth, seed, one.theta)))
    return np.array(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="number of logs of each")
    parser.add_argument("--seed", type=int, default=30_000, help="of the first log")
    options = parser.parse_args()
    print("| robot | condition | blind | / default | of the model |\n|---|---|---|---|---|")
    for name in ROBOTS:
        for condition in CONDITIONS:
            if condition.name in LACKING:
                seeds = range(options.seed, options.seed + options.seeds)
                ours, former = np.array([errors(name, condition, s) for s in seeds]).swapaxes(0, 1)
                ratio, model = np.exp(np.mean(np.log(ours / former), axis=0))
                median = 100.0 * np.median(ours[:, 0])
                print(f"| {name} | {condition.name} | {median:.2g} | {ratio:.2f} | {model:.2f} |")


if __name__ == "__main__":
    main()
