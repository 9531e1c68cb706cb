"""How often the verdict names what the model of a robot lacks: `python benchmarks/named.py`.

Logs of the gauntlet in which the model lacks one thing, and clean ones, identified by the blind
procedure. *Right* are the verdicts that name this, *other* those that name something else, *none*
those that name nothing because no parameter moves by more than its error [%].
"""

from __future__ import annotations

import argparse
import re
from collections import Counter
from concurrent.futures import ProcessPoolExecutor

from conditions import CONDITIONS, UNSEEN, log, robot_named
from gauntlet import blind

from scarid_cli.algorithms.statistics.alternatives import (
    DECAYED,
    DRIFT,
    LOAD,
    OFFSET,
    SATURATION,
    SPRING,
)
from scarid_cli.algorithms.statistics.parallel import ENCODERS
from scarid_cli.algorithms.statistics.sentences import ADVICE

LACKING = {
    "clean": (),
    "load friction": (LOAD,),
    "Stribeck friction": (*DECAYED,),
    "cable pulls": (SPRING,),
    "motor saturates": (SATURATION,),
    "torque drifts": (DRIFT,),
    "torque offset": (OFFSET,),
    "eccentric encoder": (ENCODERS,),
}
FITTED = "offsets of the torques"  # which are not alternatives, but fitted with the parameters
KNOWN = {condition.name: condition for condition in (*CONDITIONS, *UNSEEN)}
LOGS = {"scara2": 40, "planar2-gravity": 40, "ur10": 10}
SEED = 30_000


def named(job: tuple[str, str, int]) -> list[str]:
    """The alternatives that the verdict on a log names; at most one."""
    name, condition, seed = job
    result, _ = blind(name, log(robot_named(name), KNOWN[condition], seed))
    reasons = "; ".join(result.meta.extra["reasons"])
    words = {one: max(re.split(r"{\w+}", advice), key=len) for one, advice in ADVICE.items()}
    fitted = [OFFSET] if FITTED in reasons else []
    return [*fitted, *(one for one, text in words.items() if text in reasons)]


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    print(f"{'':36}{'right':>7}{'other':>7}{'none':>7}")
    with ProcessPoolExecutor(2) as pool:
        for name, count in LOGS.items():
            for condition, lacking in LACKING.items():
                jobs = [(name, condition, SEED + k) for k in range(count)]
                found: Counter[str] = Counter()
                for one in pool.map(named, jobs):
                    found["right" if {*one} & {*lacking} else "other" if one else "none"] += 1
                shares = [100 * found[what] // count for what in ("right", "other", "none")]
                print(
                    f"{name + ', ' + condition:36}" + "".join(f"{x:7d}" for x in shares), flush=True
                )


if __name__ == "__main__":
    main()
