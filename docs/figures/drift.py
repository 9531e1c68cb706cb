"""Drift over months: viscous friction that grows by 0.02 N m s/rad a month, and the trend that is told.

sed "s/viscous = 0.5/viscous = FRICTION/" samples/arm.toml > arm.toml; cp samples/arm.urdf .
scarid trajgen --robot arm.toml --seed MONTH then simulate --seed MONTH --with coloured-torque-noise=0.1 --with torque-noise-time=0.3 then identify -o monthMONTH.parquet
scarid compare month*.parquet -o drift.csv
"""

from __future__ import annotations

from pathlib import Path

import pyarrow.parquet as pq
from figures import common
from figures.common import INK, PALETTE, Data
from matplotlib.figure import Figure

MONTHS = range(1, 7)
SHOWN = ("fv1", "fs1+")  # viscous friction grows, Coulomb friction stays
COULOMB = 1.0  # N m
START, GROWTH = 0.5, 0.02  # N m s/rad, in the first month and more in each


def data() -> Data:
    """Of each month the intervals of two parameters, and what `compare` says."""
    change, identify, compare = __doc__.strip().split("\n")[2:]
    found: Data = {name: [] for name in SHOWN}
    with common.shell() as run:
        for month in MONTHS:
            run(change.replace("FRICTION", f"{_friction(month):g}"))
            run(identify.replace("MONTH", str(month)))
            for row in pq.read_table(f"month{month}.parquet").to_pylist():
                if (name := row["parameter"]) in SHOWN:
                    values = [row[key] for key in ("low", "estimate", "high")]
                    found[name].append(common.rounded(values))
        run(f"{compare} 2> said.txt")
        found["said"] = Path("said.txt").read_text("utf-8").strip().split("\n")
    return found


def _friction(month: int) -> float:
    return START + GROWTH * (month - 1)


def drawn(found: Data) -> Figure:
    """The parameter that grows, and one that stays, with the simulated truth."""
    figure, blocks = common.panels(1, 2, 2.5)
    units = ("N m s/rad", "N m")
    for axes, name, unit in zip(blocks, SHOWN, units, strict=True):
        for month, (low, middle, high) in zip(MONTHS, found[name], strict=True):
            axes.errorbar(month, middle, [[middle - low], [high - middle]], fmt="o", markersize=4,
                          color=PALETTE[0], linewidth=1.6, capsize=3)  # fmt: skip
        truth = [_friction(m) if name == SHOWN[0] else COULOMB for m in MONTHS]
        axes.plot(MONTHS, truth, color=INK, linestyle="--", linewidth=0.8)
        axes.set(xlabel="month", ylabel=f"{name} [{unit}]")
    errors = found["said"][-1].rpartition("(")[2].rstrip(")")
    for axes, title in zip(blocks, (f"fv1: a trend of {errors}", "fs1+: no trend"), strict=True):
        axes.set_xlim(0.5, len(MONTHS) + 0.5)
        axes.set_title(title, loc="left", fontsize=8.5, fontweight="bold")
    return figure
