"""How often `scarid check` names a fault, by kind, and its false alarms: `make bench-checks`.

Every log is another one: robot, motion (`trajgen --seed`), noise, joint and size of the fault are
drawn. The clean logs are the same ones without the fault.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from pathlib import Path
from zlib import crc32

import numpy as np
from checks import ROBOTS, clean, named, of_log, remarks
from kinds import KINDS, Kind
from spoiled import Spoiled

from scarid_cli.algorithms.checks.finding import Finding

PRESENT = [robot for robot, path in ROBOTS.items() if "/" not in path or Path(path).exists()]


def trial(name: str, kind: Kind, seed: int) -> tuple[Spoiled, list[Finding]]:
    """The fault of this run, and what was found."""
    rng = np.random.default_rng((crc32(name.encode()), seed))
    robot = str(rng.choice([robot for robot in kind.robots if robot in PRESENT]))
    spoil, says = kind.draw(clean(robot, seed), rng)
    fault = Spoiled(robot, spoil, kind.check, says)
    return fault, remarks(fault, seed)


def row(name: str, kind: Kind, seeds: range) -> str:
    """The kind's row: how often it was named, and which other checks did not pass."""
    count, others = 0, Counter[str]()
    for seed in seeds:
        fault, found = trial(name, kind, seed)
        hit = named(fault, found)
        count += hit
        others.update({f.name for f in found if f.name != kind.check})
        if not hit:
            told = "; ".join(f"{f.name}: {f.figure} -> {f.advice}" for f in found) or "nothing"
            print(f"{name}, {fault.source}, seed {seed} ({fault.says}): {told}", file=sys.stderr)
    more = ", ".join(f"{other} {number}" for other, number in others.most_common()) or "-"
    return f"| {name} | {kind.check} | {count} of {len(seeds)} | {more} |"


def clean_row(robot: str, seeds: range) -> str:
    """The false alarms on clean logs of a robot."""
    alarms, logs = Counter[str](), 0
    for seed in seeds:
        found = of_log(clean(robot, seed), robot)
        logs += bool(found)
        alarms.update({f"{f.name} ({f.status})" for f in found})
    more = ", ".join(f"{name} {number}" for name, number in alarms.most_common()) or "-"
    return f"| {robot} | {logs} of {len(seeds)} | {more} |"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--first", type=int, default=7000)
    parser.add_argument("--kind", default="")
    args = parser.parse_args()
    seeds = range(args.first, args.first + args.seeds)
    print("| kind | check | named | also |", "|---|---|---|---|", sep="\n")
    for name, kind in KINDS.items():
        if args.kind in name:
            print(row(name, kind, seeds), flush=True)
    if not args.kind:
        print("", "| clean logs | with a remark | which |", "|---|---|---|", sep="\n")
        for robot in PRESENT:
            print(clean_row(robot, seeds), flush=True)
