"""The blind procedure on random mixtures of imperfections: `make bench-mixtures`.

    python benchmarks/mixtures.py --robots scara2 --logs 100

Each log has one to four imperfections of random kind and size, and a random rate, duration and
speed, as the logs of strangers have. Sizes are uniform in their logarithm. Nothing in the procedure
was chosen with them. The columns are those of `gauntlet.py`; *worse* are the logs with a larger
error than that of the former default [%], and *refused* how many `identify` refuses. The seeds of
the logs that are refused or confidently wrong are on stderr.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np
from conditions import Condition
from gauntlet import ROBOTS, Run, cells, run

from scarid_cli.errors import BadData

MOST = 4  # imperfections of a log
RATES, DURATIONS = (100.0, 200.0, 500.0, 1000.0), (8.0, 20.0, 60.0)  # Hz, s
SPEEDS, EXCITATIONS = (0.4, 0.7, 1.0), ("quintic", "quintic", "quintic", "fourier")
Span = tuple[float, float]
# The least and the largest size of each, in the units of `simulate --with`.
KINDS: tuple[dict[str, Span], ...] = (
    {"encoder-bits": (11, 21)},
    {"encoder-eccentricity": (1e-5, 1e-3)},
    {"position-noise": (1e-6, 1e-3)},
    {"coloured-position-noise": (1e-6, 1e-4), "position-noise-time": (0.01, 1.0)},
    {"position-delay": (0.0005, 0.02)},
    {"position-outliers": (0.0002, 0.003), "position-outlier-size": (0.001, 0.3)},
    {"torque-delay": (0.0005, 0.03)},
    {"torque-bandwidth": (8.0, 200.0)},
    {"torque-offset": (0.02, 1.0)},
    {"torque-noise": (0.3, 10.0)},
    {"coloured-torque-noise": (0.3, 4.0), "torque-noise-time": (0.02, 5.0)},
    {"torque-resolution": (0.3, 10.0)},
    {"torque-outliers": (0.0005, 0.01), "torque-outlier-size": (0.3, 10.0)},
    {"drive-bandwidth": (20.0, 200.0)},
    {"ripple": (0.02, 0.3), "ripple-cycles": (1.0, 60.0)},
    {"stribeck": (0.1, 1.0), "stribeck-velocity": (0.01, 0.5)},
    {"load-friction": (0.002, 0.05)},
    {"friction-asymmetry": (0.02, 0.3)},
    {"friction-drift": (0.02, 0.3), "friction-drift-time": (5.0, 100.0)},
    {"vibration": (0.05, 2.0), "vibration-frequency": (2.0, 40.0)},
    {"hidden-jitter": (1e-5, 2e-3)},
    {"repeated-rows": (0.002, 0.1)},
    {"lost-rows": (0.002, 0.05)},
    {"standstill-before": (0.5, 8.0), "standstill-after": (0.5, 8.0)},
)
COULOMB = ("torque-offset", "torque-outlier-size", "ripple", "stribeck")
NOISE = ("torque-noise", "coloured-torque-noise", "torque-resolution")
RELATIVE = dict.fromkeys(COULOMB, "coulomb") | dict.fromkeys(NOISE, "noise")  # what is multiplied


def mixture(seed: int) -> Condition:
    """The condition of a log with this seed."""
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(KINDS), size=rng.integers(1, MOST, endpoint=True), replace=False)
    sizes = {
        name: float(np.exp(rng.uniform(*np.log(span))))
        for kind in chosen
        for name, span in KINDS[kind].items()
    }
    if "encoder-bits" in sizes:
        sizes["encoder-bits"] = round(sizes["encoder-bits"])
    given = {name: (size,) for name, size in sizes.items() if name not in RELATIVE}
    if "vibration" in given:
        given["vibration-direction"] = tuple(rng.standard_normal(3).tolist())
    return Condition(
        f"mixture {seed}",
        given,
        {name: (RELATIVE[name], size) for name, size in sizes.items() if name in RELATIVE},
        rate=float(rng.choice(RATES)),
        duration=float(rng.choice(DURATIONS)),
        speed=float(rng.choice(SPEEDS)),
        excitation=str(rng.choice(EXCITATIONS)),
    )


def tried(name: str, seed: int) -> Run | str:
    """What is found in the log of a robot with this seed, or why it is refused."""
    try:
        return run(name, mixture(seed), seed)
    except BadData as refusal:
        return str(refusal)


def line(name: str, found: Sequence[Run | str]) -> str:
    """The row of a robot."""
    runs = [one for one in found if not isinstance(one, str)]
    blind = np.array([one.blind.torque for one in runs])
    best = np.array([min(one.hindsight) for one in runs])
    default = np.array([one.default for one in runs])
    judged = ([getattr(one.blind, x) for one in runs] for x in ("inside", "wrong", "good"))
    figures = [
        f"{len(found)}",
        f"{100.0 * np.median(blind):.2g}",
        *[f"{np.exp(np.mean(np.log(blind / other))):.2f}" for other in (best, default)],
        *[f"{100.0 * np.mean(share):.0f}" for share in (blind > default, *judged)],
        f"{len(found) - len(runs)}",
    ]
    return f"| {name} | {' | '.join(figures)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", default=",".join(ROBOTS[:2]))
    parser.add_argument("--logs", type=int, default=300, help="number of logs of each robot")
    parser.add_argument("--seed", type=int, default=70_000, help="of the first log")
    given = parser.parse_args()
    head = ("robot", "logs", "blind", "/ hindsight", "/ default", "worse", "coverage", "wrong")
    print(f"| {' | '.join((*head, 'good', 'refused'))} |\n|{'---|' * (len(head) + 2)}")
    seeds = range(given.seed, given.seed + given.logs)
    with ProcessPoolExecutor(2) as pool:
        for name, _ in cells(given.robots.split(","), [Condition("mixtures")], []):
            found = list(pool.map(partial(tried, name), seeds))
            print(line(name, found), flush=True)
            for seed, one in zip(seeds, found, strict=True):
                if isinstance(one, str) or one.blind.wrong:
                    what = one if isinstance(one, str) else "confidently wrong"
                    print(f"{name}, --seed {seed} --logs 1: {what}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
