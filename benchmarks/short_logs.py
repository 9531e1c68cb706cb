"""What `scarid validate` finds in short logs: `python benchmarks/short_logs.py`.

Pairs of logs of the simulated robot scara2, with other motions and noise: one to identify from, and
one of the same length that is unchanged, or has the torque of joint 1 ten percent too large.
Without a change, p-values (of all tests together, Bonferroni) below 5 and 1 % should be at most as
frequent as that. The half interval is that of the gain, where it is named (median).
"""

from __future__ import annotations

import argparse
import re

import numpy as np

import scarid

ROBOT = "scara2"
CHANGED = "torque-constant-error=0.1,0"
HALF = re.compile(r"motor constant of joint 1 \(torques \S+ \+- (\S+) %")


def log(seed: int, seconds: float, *imperfections: str) -> scarid.Log:
    reference = scarid.trajgen(seed=seed, robot=ROBOT, duration=seconds)
    return scarid.simulate(reference, seed=seed, robot=ROBOT, with_=imperfections)


def row(seconds: float, pairs: int) -> str:
    """A row of the table."""
    p_values, halves = [], []
    for seed in range(pairs):
        known = scarid.identify(log(1000 + seed, seconds), robot=ROBOT)
        same, other = (
            scarid.validate(log(2000 + seed, seconds, *more), parameters=known, robot=ROBOT)
            for more in ((), (CHANGED,))
        )
        p_values.append(same.meta.extra["change"]["p_value"])
        halves += [float(x) for x in HALF.findall(other.messages[-1])]
    p = np.array(p_values)
    below = f"{np.mean(p < 0.05):.1%} | {np.mean(p < 0.01):.1%}"
    return f"| {seconds:g} | {below} | {len(halves)} of {pairs} | {np.median(halves):.2g} % |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=100)
    given = parser.parse_args()
    print("| seconds | p < 5 % | p < 1 % | gain of 10 % named | its half interval |")
    print("|---|---|---|---|---|")
    for seconds in (5.0, 10.0, 20.0):
        print(row(seconds, given.pairs), flush=True)


if __name__ == "__main__":
    main()
