"""Is the torque that another motion needs within the interval that `identify` states?

    python benchmarks/within.py --seeds 5 --seed 60000

For each robot and condition, over logs and joints: the error of the prediction on another log of
the same condition, at the true motion and away from reversals, in % of the torque (median); the
stated interval of the model's torque and that of the needed torque (medians), and which part of the
errors they cover, of the logs that are good; how many logs are good. A wrong gain of a sensor shows
in no log: these conditions are left out.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from itertools import product

import numpy as np
from conditions import CONDITIONS, UNSEEN, log, robot_named
from needed import needed

from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array
from scarid_cli.stages.procedure import blind
from scarid_cli.stages.results.parameters import identified

ROBOTS = ("scara2", "planar2-gravity")
UNTOLD = ("motor constant", "gain of", "base vibrates", "positions held", "torques held")
BY_NAME = {condition.name: condition for condition in (*CONDITIONS, *UNSEEN)}
LARGE = 0.05  # of the torque


def within(job: tuple[str, str, int]) -> tuple[str, Array]:
    """The verdict, and of each joint the error and the two intervals (3, joints)."""
    name, condition, seed = job
    robot = robot_named(name)
    table = blind.identified([log(robot, BY_NAME[condition], seed)], robot)
    rows = needed(robot, BY_NAME[condition], seed)
    left = (identified(table, robot).torques(rows).T - rows.y) * (away_from_reversals(rows) > 0.0)
    torque = rows.y * (away_from_reversals(rows) > 0.0)
    errors = np.sqrt(np.sum(left**2, axis=0) / np.sum(torque**2, axis=0))
    extra = table.meta.extra
    half = quantile(0.975, extra["evidence"]["blocks"] - 1.0)
    stated = [[half * x["torque_error"], x["needed"]] for x in extra["joints"]]
    return extra["verdict"], np.array([errors, *np.transpose(stated)])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", nargs="+", default=list(ROBOTS))
    parser.add_argument("--conditions", nargs="+", default=[""], help="parts of their names")
    parser.add_argument("--seeds", type=int, default=5, help="number of logs of each")
    parser.add_argument("--seed", type=int, default=60_000, help="of the first log")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    chosen = [
        name
        for name in BY_NAME
        if not name.startswith(UNTOLD) and any(part in name for part in options.conditions)
    ]
    seeds = range(options.seed, options.seed + options.seeds)
    jobs = list(product(options.robots, chosen, seeds))
    with ProcessPoolExecutor(options.jobs) as pool:
        found = list(pool.map(within, jobs, chunksize=4))
    print("| robot | condition | error | model | needed | covered | covered | good |")
    print("|---|---|---|---|---|---|---|---|")
    for robot, condition in product(options.robots, chosen):
        own = [x for job, x in zip(jobs, found, strict=True) if job[:2] == (robot, condition)]
        print(f"| {robot} | {condition} | {line(own)} |")
    good = [x for verdict, x in found if verdict == "good"]
    errors, model, all_of_it = np.concatenate(good, axis=1)
    print(
        f"\n{len(good)} of {len(found)} logs are good; of their joints the error is within the "
        f"interval of the model's torque in {percent(errors <= model)} %, of the needed torque in "
        f"{percent(errors <= all_of_it)} %; above 5 % in {percent(errors > LARGE)} %; in "
        f"{percent(np.array([np.any(x[0] > LARGE) for x in good]))} % of the logs at some joint"
    )


def line(own: list[tuple[str, Array]]) -> str:
    good = [x for verdict, x in own if verdict == "good"]
    if not good:
        return f"- | - | - | - | - | 0 of {len(own)}"
    joints = np.concatenate(good, axis=1)
    medians = " | ".join(f"{100.0 * x:.2g}" for x in np.median(joints, axis=1))
    covered = " | ".join(f"{percent(joints[0] <= x)}" for x in joints[1:])
    return f"{medians} | {covered} | {len(good)} of {len(own)}"


def percent(marks: Array) -> int:
    return round(100.0 * float(np.mean(marks)))


if __name__ == "__main__":
    main()
