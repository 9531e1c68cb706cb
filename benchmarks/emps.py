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
from scarid_cli.stages.tune import Record, chosen, tune

ROBOT, PUBLISHED, H = reading.load("emps"), 95.1089, 1e-3
TABLE1 = ("p2smd", "ed-fir", "2smd", "astd")


def unmatched(method: Any, record: Record) -> SettledMotion:
    """Derivatives beside the positions and the torques as they were logged."""
    assert record.tau is not None
    dq, ddq = over(method, record.q[0], H)
    signals = (record.q, dq[None, :], ddq[None, :], record.tau)
    return SettledMotion(signals, np.ones(record.q.shape[1], dtype=bool))


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


def rows(record: Record) -> list[tuple[float, str]]:
    """The line of each method in the table, after its error when tuned, which sorts the lines."""
    assert record.tau is not None
    lines = []
    for name in DIFFERENTIATORS.names:
        method = DIFFERENTIATORS.load(name)
        start = method(**method.PRESETS["table1"]) if name in TABLE1 else method()
        fitted = start.fitted(record.q[0], H)
        tuned = fitted
        if method.TUNED or method.HAS_LIKELIHOOD:
            _, settings = chosen(tune(record, [name], ROBOT, 0, lambda: None), 1)
            tuned = method(**{key: values[0] for key, values in settings[name].items()})
        motions = [unmatched(start, record)]
        motions += [motion([m], record.q, record.tau, H) for m in (fitted, tuned)]
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
    for _, line in sorted(rows(Record(q, tau, H))):
        print(line)


if __name__ == "__main__":
    main()
