"""How often `scarid validate` calls a change by its name: `make bench-changed`.

Pairs of simulated logs of six-axis arms (six_axes.py), of 20 s: the parameters are identified from
the first and validated on the second, in which one thing has changed. A change counts as called if
the verdict names it, the joint included, and nothing else beside it. Thresholds were chosen with
the arms 0 to 3 and seeds below 100 (`--tuning`); the arms and seeds that judge are others.
"""

from __future__ import annotations

import argparse
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from six_axes import JOINTS, Arm, arm, differentiated, loaded, log, rubbed

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.arrays import Array
from scarid_cli.io.table import Table
from scarid_cli.stages.compare import compare
from scarid_cli.stages.identify import identify
from scarid_cli.stages.results.changes import known
from scarid_cli.stages.results.parameters import identified
from scarid_cli.stages.validate import validate

JUDGING, TUNING = (range(110, 120), 2000), (range(4), 0)  # arms, and the first seed
TREATMENT = Treatment(slow=(0.1,) * JOINTS)


def _gains(joint: int, gain: float) -> Array:
    gains = np.ones(JOINTS)
    gains[joint - 1] = gain
    return gains


def second(kind: str, made: Arm, seed: int, joint: int, rng: np.random.Generator) -> Table:
    """The second log of a pair."""
    at = (seed, 1)
    if kind == "payload":
        return log(made, loaded(made, 1.0, rng.uniform(-0.1, 0.1, 3)), at)
    if kind == "motor constant":
        return log(made, made.theta, at, _gains(joint, rng.choice((0.95, 1.05))))
    if kind == "friction":
        return log(made, rubbed(made, 4.0 / 3.0, joint), at)
    if kind == "friction of all":
        return log(made, rubbed(made, 4.0 / 3.0), at)
    if kind == "zero":
        return log(made, made.theta, at, zeros=0.1 * (np.arange(1, JOINTS + 1) == joint))
    if kind == "delay":
        return log(made, made.theta, at, delay=3)
    if kind == "reversed":
        return log(made, made.theta, at, _gains(joint, -1.0))
    return log(made, made.theta, at)


KINDS = {
    "nothing": "nothing",
    "payload": "another payload of 1 kg",
    "motor constant": "a motor constant off by 5 %",
    "friction": "friction of one joint risen by a third",
    "friction of all": "friction of all joints risen by a third",
    "delay": "torques 15 ms later",
    "zero": "zero of one of joints 2 to 5 off by 0.1 rad",
    "reversed": "torque of one joint reversed",
}


@cache
def made_arm(number: int) -> Arm:
    return arm(number)


def verdicts(arms: range, seed: int) -> list[tuple[str, str]]:
    """The kind of change, and what it was called: "so", "nothing", or the verdict."""
    made = made_arm(arms[seed % len(arms)])
    rng = np.random.default_rng([7, seed])
    joint = int(rng.integers(1, JOINTS + 1))
    gls = ESTIMATORS.load("gls")()
    zeros = np.zeros(len(made.theta))

    def estimated(measured: Table) -> Table:
        found = identify(differentiated(measured), made.robot, gls, zeros, treatment=TREATMENT)
        (batch,) = found.batches
        return replace(found, batches=[batch])  # type: ignore[arg-type]

    before = estimated(log(made, made.theta, (seed, 0)))
    model = identified(before, made.robot)
    found: list[tuple[str, str]] = []
    for kind in KINDS:
        one = 2 + joint % (JOINTS - 2) if kind == "zero" else joint
        motion = differentiated(second(kind, made, seed, one, rng))
        result = validate(
            motion, model, treatment=TREATMENT, before=known(before, made.robot, zeros)
        )
        found.append((kind, called(kind, one, result.meta.extra["change"])))
    after = estimated(log(made, made.theta, (seed, 1)))
    facts = compare([before, after])[0].meta.extra["comparisons"][0]
    return [*found, ("compare", "differ" if facts["differ"] else "nothing")]


def called(kind: str, joint: int, change: dict[str, Any]) -> str:
    """The verdict in a word where it is right, or as it reads."""
    joints = {
        "motor constant": (joint,),
        "friction": (joint,),
        "zero": (joint,),
        "friction of all": range(1, JOINTS + 1),
    }
    expected = [("friction" if kind == "friction of all" else kind, [*joints.get(kind, ())])]
    if change["verdict"] == "unchanged":
        return "nothing"
    explained = [(e["kind"], e["joints"]) for e in change.get("explanations", [])]
    right = change["verdict"] == "changed" and explained == expected
    rewired = change.get("wiring") == [f"torque of joint {joint} reversed"]
    return "so" if right or (kind == "reversed" and rewired) else change["reason"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=100, help="number of pairs of each kind")
    parser.add_argument("--first", type=int, default=0, help="number of the first pair")
    parser.add_argument("--verbose", action="store_true", help="show what was called otherwise")
    parser.add_argument("--tuning", action="store_true", help="arms and seeds of the tuning")
    given = parser.parse_args()
    counts: Counter[tuple[str, str]] = Counter()
    with ProcessPoolExecutor(2) as pool:
        arms, start = TUNING if given.tuning else JUDGING
        runs = range(start + given.first, start + given.first + given.pairs)
        for run, found in zip(runs, pool.map(verdicts, [arms] * len(runs), runs), strict=True):
            for kind, name in found:
                counts[kind, name if name in ("so", "nothing", "differ") else "otherwise"] += 1
                if given.verbose and name not in ("so", "nothing"):
                    print(f"{run} {kind}: {name}", flush=True)
    print(f"What changed between two logs, {given.pairs} pairs each, and what it was called")
    print(f"{'':44}{'so':>6}{'otherwise':>12}{'nothing':>10}")
    for kind, text in KINDS.items():
        row = [counts[kind, name] for name in ("so", "otherwise", "nothing")]
        print(f"{text:44}{row[0]:6}{row[1]:12}{row[2]:10}")
    differ = counts["compare", "differ"]
    print(f"compare: parameters are said to differ in {differ} pairs in which nothing changed")


if __name__ == "__main__":
    main()
