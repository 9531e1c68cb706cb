"""Coverage of the confidence intervals, and detection of bias: `make montecarlo`.

Experiments are simulated as by `scarid trajgen` and `scarid simulate` with their defaults, and
identified as by `scarid differentiate` and `scarid identify --estimator wls --drop-slow 0.1
--align`. The first table says how often the 95 % interval of each parameter contains its true
value. The second says how often the verdict reports a bias, with matched and with unmatched
signals, and how many runs it detects of those with an estimate off by more than three errors.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
import pyarrow as pa
from crossvalidation import Experiment, log, seen
from defaults import PERIOD, ROBOT

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.statistics.jackknife import Z95
from scarid_cli.arrays import Array
from scarid_cli.io.table import Metadata, Table, doubles
from scarid_cli.stages.identify import identify

RECOMMENDED = Treatment(slow=(0.1, 0.1), align=True)
COLUMNS = [f"{signal}{i}" for signal in ("q", "dq", "ddq", "tau") for i in (1, 2)]
UNMATCHED: list[tuple[str, dict[str, float]]] = [
    ("kalman", {}),
    ("p2smd", DIFFERENTIATORS.load("p2smd").PRESETS["table1"]),
    ("ed-fir", {}),
    ("high-gain", {}),
    ("savgol-end", {}),
]
Identified = tuple[Array, Array, Array, Array, dict[str, Any]]


def identified(method: Any, log: Experiment, *, match: bool = True) -> Identified:
    """Estimates, standard errors for white residuals, ends of the intervals, and metadata."""
    motion = seen(method, *log, match=match)
    signals = np.concatenate(motion.signals)[:, motion.settled]
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in signals], COLUMNS)
    table = Table("motion", batch.schema, Metadata(kind="motion", period=PERIOD), iter([batch]))
    wls = ESTIMATORS.load("wls")()
    found = identify(table, ROBOT, wls, np.zeros(8), treatment=RECOMMENDED)
    (row,) = found.batches
    names = ("estimate", "standard_error", "low", "high")
    columns = (row.column(n).to_numpy(zero_copy_only=False) for n in names)
    estimates, errors, low, high = columns
    return estimates, errors, low, high, found.meta.extra


def coverage(runs: int, seed: int) -> None:
    """How often the intervals contain the true values [%]."""
    truth = ROBOT.apriori
    robust, white, delays = np.zeros(8), np.zeros(8), []
    kalman = DIFFERENTIATORS.load("kalman")()
    for run in range(runs):
        estimates, errors, low, high, extra = identified(kalman, log(seed + run))
        robust += (low <= truth) & (truth <= high)
        white += np.abs(estimates - truth) <= Z95 * errors
        delays.append(1e3 * extra["delay"])
    print(f"Coverage of the 95 % intervals, {runs} experiments [%]")
    print(f"{'':14}" + "".join(f"{name:>7}" for name in ROBOT.names))
    for label, counts in (("robust", robust), ("white residual", white)):
        print(f"{label:14}" + "".join(f"{100.0 * c / runs:7.1f}" for c in counts))
    print(
        f"The torques lead by {np.mean(delays):.3f} +- {np.std(delays):.3f} ms "
        "(expected: 0.5 ms, half a period of the controller, which holds each command)"
    )


def bias(runs: int, seed: int) -> None:
    """How often the verdict reports a bias, with and without matching."""
    print(f"\nRuns reported as biased, of {runs} each")
    print(f"{'method':12}{'matched':>9}{'unmatched':>11}{'of those off by 3 errors':>30}")
    truth = ROBOT.apriori
    for name, settings in UNMATCHED:
        method = DIFFERENTIATORS.load(name)(**settings)
        clean = caught = called = off = 0
        for run in range(runs):
            record = log(seed + run)
            clean += _biased(identified(method, record)[-1])
            estimates, _, low, high, extra = identified(method, record, match=False)
            half = 0.5 * (high - low)
            wrong = bool(np.any(np.abs(estimates - truth) > 3.0 / Z95 * half))
            called += _biased(extra)
            off += wrong
            caught += wrong and _biased(extra)
        print(f"{name:12}{clean:9}{called:11}{f'{caught} of {off}':>30}", flush=True)


def _biased(extra: dict[str, Any]) -> bool:
    return any(reason.startswith("biased") for reason in extra["reasons"])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=200, help="number of experiments")
    parser.add_argument("--seed", type=int, default=10_000, help="seed of the first experiment")
    arguments = parser.parse_args()
    coverage(arguments.runs, arguments.seed)
    bias(arguments.runs // 2, arguments.seed)
