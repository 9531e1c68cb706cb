"""Why torques are matched: the torque that a soft sensor's late acceleration explains.

scarid trajgen --seed 1 then simulate --seed 1 -o log.parquet
scarid differentiate --method p2smd --MATCH log.parquet -o motion.parquet
scarid identify motion.parquet -o parameters.parquet
scarid validate --parameters parameters.parquet motion.parquet --predictions torques.parquet -o fit.parquet
"""

from __future__ import annotations

import pyarrow.parquet as pq
from figures import common
from figures.common import INK, PALETTE, Data, thinned
from matplotlib.figure import Figure

from scarid_cli.algorithms.robots.reading import load

KINDS = ("no-match", "match")
TITLES = ("--no-match: the torque is earlier", "--match: both are of the same instant")
SHOWN = (14.5, 18.5)  # s
PARAMETER = "ZZ1R"


def data(kinds: tuple[str, ...] = KINDS) -> Data:
    """Torques of joint 1 as measured, predicted and left over; the inertia's error [%]."""
    robot = load("scara2")
    true = robot.apriori[robot.names.index(PARAMETER)]
    simulate, *others = __doc__.strip().split("\n")[2:]
    found: Data = {}
    with common.shell() as run:
        run(simulate)
        for kind in kinds:
            for line in others:
                run(line.replace("MATCH", kind))
            rows = {r["parameter"]: r for r in pq.read_table("parameters.parquet").to_pylist()}
            t, measured, predicted = common.columns("torques.parquet", "t", "tau1", "tau1_pred")
            near = (t > SHOWN[0]) & (t < SHOWN[1])
            curves = (measured, predicted, measured - predicted)
            found[kind] = {
                "curves": [thinned(t[near], x[near]) for x in curves],
                "error": common.rounded([100.0 * (rows[PARAMETER]["estimate"] / true - 1.0)])[0],
            }
    return found


def drawn(found: Data) -> Figure:
    """The same seconds of the same log, without and with matching."""
    figure, blocks = common.panels(1, 2, 2.6, sharey=True)
    for axes, kind, title in zip(blocks, KINDS, TITLES, strict=True):
        measured, predicted, residual = found[kind]["curves"]
        axes.plot(*measured, color=INK, alpha=0.35, linewidth=2.0, label="tau1 [N m]")
        axes.plot(*predicted, color=PALETTE[0], label="predicted")
        axes.plot(*residual, color=PALETTE[1], label="residual")
        axes.set_xlabel(f"t [s]; {PARAMETER} is {found[kind]['error']:+.2g} % off")
        common.titled(axes, title)
    return figure
