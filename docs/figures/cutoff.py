"""The cut-off against the scatter: why `identify` chooses a bandwidth, and what others would give.

scarid trajgen --seed 1 then simulate --seed 1 -o log.parquet
scarid tune --robot scara2 log.parquet -o trials.parquet
scarid differentiate --method zero-phase --set cutoff=CUTOFF --match log.parquet then identify --estimator wls -o CUTOFF.parquet
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
import pyarrow.parquet as pq
from figures import common
from figures.common import INK, PALETTE, Data, rounded
from matplotlib.figure import Figure

from scarid_cli.algorithms.robots.reading import load

CUTOFFS = (1, 1.5, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48)  # Hz
SHOWN = ("ZZ1R", "ZZ2", "L1MX2")


def data(wanted: Sequence[float] = CUTOFFS) -> Data:
    """The share of the torque that scatter makes [%], and estimates relative to the truth."""
    simulate, tune, identify = __doc__.strip().split("\n")[2:5]
    robot = load("scara2")
    truth = np.array([robot.apriori[robot.names.index(name)] for name in SHOWN])
    ratios: dict[str, list[list[float]]] = {name: [] for name in SHOWN}
    with common.shell() as run:
        run(simulate)
        run(tune)
        rows = [r for r in pq.read_table("trials.parquet").to_pylist() if r["judge"] == "scatter"]
        for cutoff in wanted:
            run(identify.replace("CUTOFF", f"{cutoff:g}"))
            table = pq.read_table(f"{cutoff:g}.parquet").to_pylist()
            for row in table:
                if (name := row["parameter"]) in SHOWN:
                    values = [
                        row[key] / truth[SHOWN.index(name)] for key in ("low", "estimate", "high")
                    ]
                    ratios[name].append(rounded(values))
    cutoffs = [float(re.search(r"cutoff=(\S+)", r["settings"])[1]) for r in rows]  # type: ignore[index]
    return {
        "cutoffs": rounded(cutoffs),
        "scatter": rounded([100.0 * np.sqrt(r["loss"]) for r in rows]),
        "chosen": rounded([f for f, r in zip(cutoffs, rows, strict=True) if r["best"]])[0],
        "ratios": ratios,
    }


def part() -> Data:
    """The choice, without the estimates, which a test compares."""
    found = data(())
    return {name: found[name] for name in ("cutoffs", "scatter", "chosen")}


def drawn(found: Data) -> Figure:
    """The loss that is looked at, and the estimates, which the user cannot hold against a truth."""
    figure, (scatter, ratios) = common.panels(1, 2, 2.7)
    scatter.semilogx(found["cutoffs"], found["scatter"], "o-", color=PALETTE[0], markersize=3)
    scatter.set_ylabel("share of the torque [%]")
    scatter.set_ylim(bottom=0.0)
    scatter.set_title("what the scatter of the parameters makes", loc="left", fontsize=8.5,
                      fontweight="bold")  # fmt: skip
    for k, (name, rows) in enumerate(found["ratios"].items()):
        low, middle, high = np.array(rows).T
        at = np.array(CUTOFFS) * (1.0 + 0.06 * (k - 1))
        ratios.errorbar(at, middle, [middle - low, high - middle], fmt="o", markersize=3,
                        color=PALETTE[k], linewidth=1.4, label=name)  # fmt: skip
    ratios.set(xscale="log", ylim=(0.9, 1.05), ylabel="estimate / truth")
    ratios.axhline(1.0, color=INK, linestyle="--", linewidth=0.8)
    common.titled(ratios, "estimates with 95 % intervals")
    for axes in (scatter, ratios):
        axes.set_xlim(0.9, 55.0)
        axes.set_xticks([1, 2, 5, 10, 20, 50])
        axes.axvline(found["chosen"], color=PALETTE[1], linewidth=1.2)
        axes.set_xlabel("cut-off [Hz]; the line is the one chosen")
        common.plain_powers(axes)
    return figure
