"""One log's verdict explained: what its numbers are, and what they are held against.

scarid identify --robot scara2 samples/scara2.csv -o parameters.parquet

The line says: good: 6 of 8 parameters known within 30 % (all but ...); model torque within ... %;
residual ... %; inertia within ... %.
"""

from __future__ import annotations

import json
import re

import pyarrow.parquet as pq
from figures import common
from figures.common import GREY, INK, PALETTE, Data
from matplotlib.axes import Axes
from matplotlib.figure import Figure

KNOWN = 30.0  # percent: a parameter is known if its error is at most this part of it
NARROW, WIDE = 10.0, 30.0  # percent: half the interval of the torque of a good and a rough model
NUMBER = r"(\d+\.?\d*) %"
PARTS = ("model torque within", "needed torque within", "residual", "inertia within")


def data() -> Data:
    """The verdict, the errors of the parameters [%], and the numbers of the line [%]."""
    with common.shell() as run:
        run(__doc__.strip().split("\n")[2])
        table = pq.read_table("parameters.parquet")
    extra = json.loads(table.schema.metadata[b"scarid"])["extra"]
    line = extra["reasons"][0]
    rows = table.to_pylist()
    return {
        "verdict": extra["verdict"],
        "line": line,
        "errors": {r["parameter"]: common.rounded([_error(r)])[0] for r in rows},
        **{part: _numbers(line, part) for part in PARTS},
    }


def _error(row: Data) -> float:
    return 100.0 * float(row["robust_error"]) / abs(float(row["estimate"]))


def _numbers(line: str, part: str) -> list[float]:
    (found,) = (text for text in line.split("; ") if text.startswith(part))
    return [float(x) for x in re.findall(NUMBER, found)]


def drawn(found: Data) -> Figure:
    """The errors of the parameters beside 30 %, and the joints beside the limits of the grades."""
    figure, (errors, joints) = common.panels(1, 2, 2.9)
    _errors(errors, found["errors"])
    _joints(joints, found)
    figure.suptitle(f"scarid identify: {found['verdict']}", x=0.01, ha="left", fontweight="bold")
    return figure


def _errors(axes: Axes, errors: dict[str, float]) -> None:
    known = [error <= KNOWN for error in errors.values()]
    colours = [PALETTE[0] if one else PALETTE[1] for one in known]
    axes.barh(range(len(errors)), list(errors.values()), height=0.6, color=colours)
    axes.set_yticks(range(len(errors)), list(errors))
    axes.set(xscale="log", xlim=(0.1, 1000.0), ylim=(len(errors) - 0.5, -0.5))
    axes.axvline(KNOWN, color=INK, linestyle="--", linewidth=0.9)
    axes.set_xlabel("standard error [% of the estimate]; dashed: 30 %")
    common.plain_powers(axes)
    title = f"“{sum(known)} of {len(known)} parameters known within 30 %”"
    axes.set_title(title, loc="left", fontsize=8.5, fontweight="bold")


def _joints(axes: Axes, found: Data) -> None:
    place, names = 0, []
    for colour, part in zip((PALETTE[0], PALETTE[3], GREY, PALETTE[2]), PARTS, strict=True):
        for joint, value in enumerate(found[part], start=1):
            axes.barh(place, value, height=0.6, color=colour)
            axes.annotate(f"{value:g} %", (value, place), (3, 0), textcoords="offset points",
                          va="center")  # fmt: skip
            names.append(f"{part.removesuffix(' within')}, {joint}")
            place += 1
    axes.set_yticks(range(place), names)
    axes.set(xscale="log", xlim=(0.1, 100.0), ylim=(place - 0.5, -1.4))
    for limit, text, side in ((NARROW, "rough above", "right"), (WIDE, "doubtful above", "left")):
        axes.plot(
            [limit, limit],
            [-0.5, 3.5 if limit == NARROW else 1.5],
            color=INK,
            linestyle="--",
            linewidth=0.9,
        )
        axes.text(limit, -0.75, text, fontsize=7, ha=side)
    axes.set_xlabel("[%]")
    common.plain_powers(axes)
    axes.set_title("“... within ...”, by joint", loc="left", fontsize=8.5, fontweight="bold")
