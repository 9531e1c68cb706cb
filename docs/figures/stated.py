"""Why stated errors are usually too small: 40 experiments, textbook and robust intervals.

scarid trajgen --seed SEED then simulate --seed SEED then differentiate then identify --estimator wls --drop-slow 0.1 --align -o SEED.parquet

The textbook's interval is 1.96 `standard_error`, which takes residuals for white noise; the other
one is from `low` to `high`.
"""

from __future__ import annotations

import numpy as np
from figures import common
from figures.common import INK, PALETTE, Data
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from scarid_cli.algorithms.robots.reading import load

PARAMETER = "ZZ2"
SEEDS = 40
Z95 = 1.96  # standard deviations: half a 95 % interval of a normal distribution


def data(seeds: int = SEEDS) -> Data:
    """Intervals of one parameter, as [low, high], and how many of all contain the truth."""
    robot = load("scara2")
    at = robot.names.index(PARAMETER)
    white, robust, inside = [], [], np.zeros(2)
    with common.shell() as run:
        for seed in range(1, seeds + 1):
            run(__doc__.strip().split("\n")[2].replace("SEED", str(seed)))
            names = ("estimate", "standard_error", "low", "high")
            estimate, error, low, high = common.columns(f"{seed}.parquet", *names)
            both = [(estimate - Z95 * error, estimate + Z95 * error), (low, high)]
            for k, (a, b) in enumerate(both):
                inside[k] += np.mean((a <= robot.apriori) & (robot.apriori <= b))
            for ends, (a, b) in zip((white, robust), both, strict=True):
                ends.append(common.rounded([a[at], b[at]]))
    found = 100.0 * inside / seeds
    return {
        "truth": float(robot.apriori[at]),
        "white": white,
        "robust": robust,
        "coverage": [round(float(x), 1) for x in found],
    }


def part() -> Data:
    """The intervals of one experiment, which a test compares."""
    found = data(1)
    return {"truth": found["truth"], "white": found["white"], "robust": found["robust"]}


def drawn(found: Data) -> Figure:
    """The intervals of both kinds, on one scale; those that miss the truth in another colour."""
    figure, blocks = common.panels(1, 2, 2.9, sharex=True, sharey=True)
    titles = ("textbook: ± 1.96 standard_error", "scarid: low to high")
    for axes, kind, title, coverage in zip(
        blocks, ("white", "robust"), titles, found["coverage"], strict=True
    ):
        missed = _intervals(axes, found[kind], found["truth"])
        axes.set_title(
            f"{title}\n{missed} of {len(found[kind])} miss the truth here; of all eight "
            f"parameters,\n{coverage:g} % of the intervals contain it",
            loc="left", fontsize=8,
        )  # fmt: skip
        axes.set_xlabel("experiment")
    blocks[0].set_ylabel(f"{PARAMETER} [kg m2]")
    return figure


def _intervals(axes: Axes, intervals: list[list[float]], truth: float) -> int:
    missed = 0
    for place, (low, high) in enumerate(intervals, start=1):
        outside = not low <= truth <= high
        missed += outside
        axes.plot([place, place], [low, high], color=PALETTE[1 if outside else 0], linewidth=2.0)
    axes.axhline(truth, color=INK, linestyle="--", linewidth=0.8)
    return missed
