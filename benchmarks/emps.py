"""Every differentiator on the real EMPS log: unmatched, matched, and matched and tuned.

`make emps` or `python benchmarks/emps.py emps_train.csv` prints a table in Markdown: the mass [kg]
estimated by least squares, and the error of the torque predicted for the same log, relative to the
norm of the torque [%]. Published offline values are 95.1089 kg and 4.08 %. Tuned settings are those
of `scarid tune --robot emps`: all have the cut-off at which the parameters scatter least.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pyarrow.csv
from matched import SettledMotion, identified, motion

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.processes.matching import over
from scarid_cli.algorithms.robots import reading
from scarid_cli.arrays import Array
from scarid_cli.stages.procedure.bandwidth import bandwidth, tune_for
from scarid_cli.stages.records.record import Record
from scarid_cli.stages.tune import chosen

ROBOT, PUBLISHED, H = reading.load("emps"), 95.1089, 1e-3
TABLE1 = ("p2smd", "ed-fir", "2smd", "astd")


def unmatched(method: Any, q: Array, tau: Array) -> SettledMotion:
    """Derivatives beside the positions and the torques as they were logged."""
    dq, ddq = over(method, q[0], H)
    signals = (q, dq[None, :], ddq[None, :], tau)
    return SettledMotion(signals, np.ones(q.shape[1], dtype=bool))


def quality(seen: SettledMotion) -> tuple[float, float]:
    """Mass [kg], and relative error of the predicted torque [%]."""
    rows = seen.settled
    theta = identified(ROBOT, seen, rows)
    if theta is None:
        return float("nan"), float("nan")
    q, dq, ddq, tau = (np.ascontiguousarray(signal[:, rows]) for signal in seen.signals)
    wrong = tau - ROBOT.torques(ROBOT.regressor(q, dq, ddq), theta)
    return float(theta[0]), 100.0 * float(np.linalg.norm(wrong) / np.linalg.norm(tau))


def shown(mass: float, error: float) -> str:
    return f"{mass:.2f} ({100.0 * (mass / PUBLISHED - 1.0):+.1f} %) | {error:.2f}"


def rows(q: Array, tau: Array) -> list[tuple[float, str]]:
    """The line of each method in the table, after its error when tuned, which sorts the lines."""
    record, lines = Record((np.vstack((q, tau)),), 1, H), []
    found = bandwidth(record, ROBOT)
    for name in DIFFERENTIATORS.names:
        method = DIFFERENTIATORS.load(name)
        start = method(**method.PRESETS["table1"]) if name in TABLE1 else method()
        fitted = start.fitted(q[0], H)
        tuned = fitted
        if method.TUNED or method.HAS_LIKELIHOOD:
            trials = list(tune_for(record, found, [name], 0, lambda: None))
            settings = chosen(trials, 1)[name]
            tuned = method(**{key: values[0] for key, values in settings.items()})
        motions = [unmatched(start, q, tau)]
        motions += [motion([m], q, tau, H) for m in (fitted, tuned)]
        results = [quality(seen) for seen in motions]
        cells = [shown(*result) for result in results]
        label = f"`{name}`" + (" (Table 1)" if name in TABLE1 else "")
        kind = {0: "causal", np.inf: "whole record"}.get(start.lag(H), "fixed lag")
        cells[2] = cells[2] if tuned is not fitted else "| "
        lines.append((results[2][1], f"| {label} | {kind} | {' | '.join(cells)} |"))
    return lines


def main() -> None:
    table = pyarrow.csv.read_csv(sys.argv[1])
    q, tau = (np.array([table[name].to_numpy()]) for name in ("q1", "tau1"))
    print("| method | class | mass, unmatched [kg] | error [%] | mass, matched [kg] | error [%] "
          "| mass, matched and tuned [kg] | error [%] |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|")
    for _, line in sorted(rows(q, tau)):
        print(line)


if __name__ == "__main__":
    main()
