"""How often `scarid check` names the torques that have another sign than described.

    python benchmarks/signs.py --robots ur10,panda --seeds 3

The torques of simulated logs of the gauntlet get random signs. With --scale each is multiplied by
a random factor from 0.3 to 3 as well, like currents of motors of unknown constants. A log is right
if the check names exactly the reversed torques (all of them, if that is so), and passes where none
are reversed.
"""

from __future__ import annotations

import argparse
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace

import numpy as np
from conditions import CONDITIONS, UNSEEN, Condition, log, robot_named
from gauntlet import cells

from scarid_cli.algorithms.checks.finding import OK, Finding
from scarid_cli.stages.check import check
from scarid_cli.stages.records.logs import log_of

ALL = "the friction of every joint would drive it"
CHOSEN = "clean,all together,Stribeck,outliers,standstill"


@dataclass(frozen=True)
class Case:
    robot: str
    condition: Condition
    seed: int
    scale: bool


def right(case: Case) -> bool:
    """Whether the check names the torques that are reversed."""
    robot = robot_named(case.robot)
    joints = len(robot.joints)
    rng = np.random.default_rng(case.seed)
    signs = rng.choice([1.0, -1.0], joints)
    factors = rng.uniform(0.3, 3.0, joints) if case.scale else np.ones(joints)
    read = log_of(log(robot, case.condition, case.seed), joints)
    read = replace(read, tau=(signs * factors)[:, None] * read.tau)
    found = [one for one in check(read, robot) if one.name == "signs"]
    return bool(found) and _named(
        found[0], [j + 1 for j in range(joints) if signs[j] < 0.0], joints
    )


def _named(found: Finding, joints: list[int], every: int) -> bool:
    """Whether it names these joints, of so many."""
    if not joints:
        return found.status == OK
    listed = ", ".join(map(str, joints))
    words = f"torque of joint{'s' if len(joints) > 1 else ''} {listed} reversed"
    return (ALL if len(joints) == every else words) in found.figure


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default="scara2,ur10,panda")
    parser.add_argument("--conditions", default=CHOSEN, help="parts of their names, with commas")
    parser.add_argument("--seeds", type=int, default=3, help="number of logs of each")
    parser.add_argument("--seed", type=int, default=30_000, help="seed of the first log")
    parser.add_argument("--scale", action="store_true", help="torques times random factors as well")
    given = parser.parse_args()
    conditions = given.conditions.split(",")
    cases = [
        Case(name, condition, seed, given.scale)
        for known in (CONDITIONS, UNSEEN)
        for name, condition in cells(given.robots.split(","), known, conditions)
        for seed in range(given.seed, given.seed + given.seeds)
    ]
    logs, named = Counter(case.robot for case in cases), Counter[str]()
    with ProcessPoolExecutor(2) as pool:
        for case, good in zip(cases, pool.map(right, cases, chunksize=2), strict=True):
            named[case.robot] += good
    for name, count in logs.items():
        print(f"{name}: {named[name]} of {count} right")


if __name__ == "__main__":
    main()
