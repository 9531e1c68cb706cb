"""What `scarid validate` says of unchanged robots that move otherwise than at the identification.

    python benchmarks/motions.py --robots scara2,planar2-gravity --seeds 4

Each robot follows four kinds of motion, simulated with its encoders and noise. It is identified
from each with nothing set, and each identification is validated with the logs of the other three
kinds. All verdicts should be `unchanged`. Nothing was chosen with these logs.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from itertools import permutations
from pathlib import Path

from arms import ARMS, URDFS, described

KINDS = {
    "fourier": ["--excitation", "fourier", "--dq-max", "1.5"],
    "spline": ["--excitation", "spline", "--dq-max", "1.5"],
    "quintic": ["--excitation", "quintic", "--dq-max", "1.5"],
    "slow quintic": ["--excitation", "quintic", "--dq-max", "0.5"],
}
LIMITS = ["--q-max", "1", "--ddq-max", "5", "--home", "0"]
RATE, DURATION = 200, 30  # Hz, s
FIRST = 30_000  # the first seed, which nothing was chosen with


def scarid(*words: object) -> str:
    """Run a command, and return what it says."""
    program = Path(sys.executable).with_name("scarid")
    done = subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(done.stderr)
    return done.stderr


def verdicts(robot: str, folder: Path, seed: int) -> list[tuple[str, str, str]]:
    """The kinds of both motions of each pair, and what `validate` says of it."""
    for number, options in enumerate(KINDS.values()):
        own = 4 * seed + number
        reference, log, found = (folder / f"{own}.{x}" for x in ("ref", "log", "parameters"))
        made = ("trajgen", "-q", "--robot", robot, "--seed", own, *options, *LIMITS)
        scarid(*made, "--rate", RATE, "--duration", DURATION, "-o", f"{reference}.parquet")
        scarid("simulate", "-q", "--seed", own, f"{reference}.parquet", "-o", f"{log}.parquet")
        scarid("identify", "-q", f"{log}.parquet", "-o", f"{found}.parquet")
    kinds, found_in = list(KINDS), []
    for first, second in permutations(range(len(KINDS)), 2):
        parameters = folder / f"{4 * seed + first}.parameters.parquet"
        log = folder / f"{4 * seed + second}.log.parquet"
        metrics = folder / f"{seed}.metrics.csv"
        said = scarid("validate", "--parameters", parameters, log, "-o", metrics)
        said = said.splitlines()[-1].removeprefix("scarid validate: ")
        found_in.append((kinds[first], kinds[second], said))
    return found_in


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default="scara2,planar2-gravity,ur10,panda")
    parser.add_argument("--seeds", type=int, default=2, help="number of logs of each kind")
    parser.add_argument("--verbose", action="store_true", help="show the other verdicts")
    given = parser.parse_args()
    print("Verdicts on unchanged robots under other motions")
    with tempfile.TemporaryDirectory() as name, ProcessPoolExecutor(2) as pool:
        for robot in given.robots.split(","):
            (folder := Path(name) / robot).mkdir()
            path = described(URDFS / f"{robot}.urdf", folder) if robot in ARMS else robot
            seeds = range(FIRST, FIRST + given.seeds)
            pairs = [
                x for own in pool.map(partial(verdicts, str(path), folder), seeds) for x in own
            ]
            counts = Counter(said.partition(":")[0] for _, _, said in pairs)
            print(f"{robot}: {', '.join(f'{n} {verdict}' for verdict, n in counts.most_common())}")
            for first, second, said in pairs:
                if given.verbose and not said.startswith("unchanged"):
                    print(f"  {first} -> {second}: {said}")


if __name__ == "__main__":
    main()
