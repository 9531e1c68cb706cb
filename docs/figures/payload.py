"""A payload found: torques that the bare robot's parameters do not explain, and what hangs there.

scarid trajgen --robot samples/robots/ur10e.toml --seed 1 -o motion.parquet
scarid simulate --seed 1 motion.parquet -o bare-log.parquet
scarid simulate --seed 2 --with payload=2,0.02,-0.01,0.06,0.004,0,0,0.004,0,0.002,0 motion.parquet -o loaded-log.parquet
scarid identify bare-log.parquet -o bare.parquet
scarid validate --parameters bare.parquet loaded-log.parquet --predictions torques.parquet -o fit.parquet
scarid payload --parameters bare.parquet --frame wrist_3 loaded-log.parquet -o payload.parquet
"""

from __future__ import annotations

import pyarrow.parquet as pq
from figures import common
from figures.common import INK, PALETTE, Data, thinned
from matplotlib.figure import Figure

TRUTH = {"mass": 2.0, "x": 0.02, "y": -0.01, "z": 0.06}
JOINT = 3  # the elbow


def data() -> Data:
    """Torques of the elbow, and the intervals of mass and centre."""
    with common.shell() as run:
        for line in __doc__.strip().split("\n")[2:]:
            run(line)
        names = ("t", f"tau{JOINT}", f"tau{JOINT}_pred")
        t, measured, predicted = common.columns("torques.parquet", *names)
        rows = {r["quantity"]: r for r in pq.read_table("payload.parquet").to_pylist()}
    return {
        "measured": thinned(t, measured),
        "predicted": thinned(t, predicted),
        "payload": {
            name: common.rounded([rows[name][key] for key in ("low", "estimate", "high")])
            for name in TRUTH
        },
    }


def drawn(found: Data) -> Figure:
    """The torque beside its prediction, then mass and centre beside the truth."""
    figure, (torque, mass, centre) = common.panels(1, 3, 2.5, width_ratios=(2.2, 0.7, 1.3))
    torque.plot(*found["measured"], color=INK, alpha=0.35, linewidth=2.0, label="loaded")
    torque.plot(*found["predicted"], color=PALETTE[0], label="predicted, bare")
    torque.set(xlabel="t [s]", ylabel=f"tau{JOINT} [N m]")
    common.titled(torque, "the elbow's torque")
    _intervals(mass, found["payload"], ["mass"], 1.0)
    common.titled(mass, "mass [kg]")
    _intervals(centre, found["payload"], ["x", "y", "z"], 1e3)
    common.titled(centre, "centre [mm]")
    return figure


def _intervals(axes: common.Axes, payload: Data, names: list[str], scale: float) -> None:
    """Estimates with their 95 % intervals; a cross marks the truth."""
    for place, name in enumerate(names):
        low, middle, high = (scale * x for x in payload[name])
        axes.errorbar(place, middle, [[middle - low], [high - middle]], fmt="o", markersize=4,
                      color=PALETTE[0], linewidth=1.6, capsize=3)  # fmt: skip
        axes.plot(place + 0.22, scale * TRUTH[name], "x", color=PALETTE[1], markersize=6)
    axes.plot([], [], "o", color=PALETTE[0], label="found")
    axes.plot([], [], "x", color=PALETTE[1], label="truth")
    axes.set_xticks(range(len(names)), names)
    axes.set_xlim(-0.5, len(names) - 0.5)
