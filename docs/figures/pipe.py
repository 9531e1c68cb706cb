"""The pipe at a glance: a log, its soft sensor, the parameters settling, torques and residuals.

scarid trajgen --seed 1 | scarid simulate --truth -o log.parquet
scarid differentiate log.parquet -o motion.parquet
scarid identify motion.parquet --trace trace.parquet -o parameters.parquet
scarid validate --parameters parameters.parquet motion.parquet --predictions torques.parquet -o fit.csv
"""

from __future__ import annotations

from figures import common
from figures.common import INK, PALETTE, Data, thinned
from matplotlib.figure import Figure

from scarid_cli.algorithms.robots.reading import load

SETTLING = ("ZZ1R", "ZZ2", "L1MX2", "Fs1", "Fs2")


def data() -> Data:
    """Curves of joint 1, and the estimates relative to the truth."""
    robot = load("scara2")
    truth = [robot.apriori[robot.names.index(name)] for name in SETTLING]
    with common.shell() as run:
        for line in __doc__.strip().split("\n")[2:]:
            run(line)
        t, q1, q2, tau1, tau2 = common.columns("log.parquet", "t", "q1", "q2", "tau1", "tau2")
        names = ("t", "ddq1", "ddq1_true", "settled")
        time, estimate, true, settled = common.columns("motion.parquet", *names)
        settled = settled.astype(bool)
        trace = common.columns("trace.parquet", "t", *SETTLING)
        torques = common.columns("torques.parquet", "t", "tau1", "tau1_pred")
    return {
        "log": {"q1": thinned(t, q1), "q2": thinned(t, q2), "tau1": thinned(t, tau1),
                "tau2": thinned(t, tau2)},
        "acceleration": [thinned(time[settled], x[settled]) for x in (estimate, true)],
        "settling": {name: thinned(trace[0], x / true)
                     for name, x, true in zip(SETTLING, trace[1:], truth, strict=True)},
        "torque": [thinned(torques[0], x) for x in torques[1:]],
        "residual": thinned(torques[0], torques[1] - torques[2]),
    }  # fmt: skip


def drawn(found: Data) -> Figure:
    """Four panels in the order of the pipe."""
    figure, (log, sensor, settling, torque) = common.panels(2, 2, 4.4, sharex=True)
    for k, name in enumerate(("q1", "q2")):
        log.plot(*found["log"][name], color=PALETTE[k], label=f"{name} [rad]")
    beside = log.twinx()
    beside.spines["right"].set_visible(True)
    beside.grid(visible=False)
    beside.plot(*found["log"]["tau1"], color=INK, alpha=0.35, linewidth=0.8)
    log.plot([], [], color=INK, alpha=0.35, label="tau1 [N m]")
    beside.set_ylabel("tau1")
    common.titled(log, "1  a log: positions and torques")
    estimate, true = found["acceleration"]
    sensor.plot(*true, color=INK, alpha=0.35, linewidth=2.2, label="truth")
    sensor.plot(*estimate, color=PALETTE[1], label="ddq1 [rad/s2]")
    common.titled(sensor, "2  scarid differentiate: accelerations")
    for k, (name, curve) in enumerate(found["settling"].items()):
        settling.plot(*curve, color=PALETTE[k], label=name)
    settling.set_ylim(0.7, 1.3)
    settling.axhline(1.0, color=INK, linestyle="--", linewidth=0.8)
    settling.set(xlabel="t [s]", ylabel="estimate / truth")
    common.titled(settling, "3  scarid identify: parameters settle")
    measured, predicted = found["torque"]
    torque.plot(*measured, color=INK, alpha=0.35, linewidth=2.2, label="tau1 [N m]")
    torque.plot(*predicted, color=PALETTE[0], label="predicted")
    torque.plot(*found["residual"], color=PALETTE[1], label="residual")
    torque.set_xlabel("t [s]")
    common.titled(torque, "4  scarid validate: torques, residuals")
    return figure
