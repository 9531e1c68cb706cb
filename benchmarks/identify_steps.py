"""Processor time and peak memory of each step of `scarid identify` on a measurement.

    python benchmarks/identify_steps.py --logs scara2:20:200,ur10:60:500,panda:600:1000

A log is NAME:SECONDS:HERTZ. A second thread looks at the stack and at the resident memory every
10 ms; a step is the time during which its function is on the stack. Then the errors of the
estimates: their rms and the largest, over the stated ones. The last line has the exponents with
which time and memory grow from 60 to 600 s of an arm with seven axes at 1 kHz.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import defaultdict
from math import log as ln
from pathlib import Path

import numpy as np

STEPS = {  # of which the first that is on the stack counts: module and function
    "spectrum, cut-off": "bandwidth.bandwidth",
    "checks": "glance.of_measurement",
    "reading": "compact.of",
    "smoothing, regressor": "identify._after_all_rows",
    "lead of the torques": "alignment.lead",
    "fits, whitening": "estimation.of_rows",
    "torques beyond the model": "effects.beyond",
    "slow noise": "autocovariance.autocovariance_errors",
    "another soft sensor": "effects.signals",
    "evidence": "outcome._evidence",
    "rest of the verdict": "outcome.outcome",
    "opening": "logs.read_logs",
}
REST = "start-up, writing"
INTERVAL = 0.01  # s
GROWTH = ("panda:60:1000", "panda:600:1000")


def resident() -> float:
    """The resident memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def step_of(thread: int) -> str:
    """The step that a thread is in."""
    frame, names = sys._current_frames().get(thread), set()  # noqa: SLF001
    while frame:
        names.add(f"{Path(frame.f_code.co_filename).stem}.{frame.f_code.co_name}")
        frame = frame.f_back
    return next((step for step, name in STEPS.items() if name in names), REST)


def watched(words: list[str]) -> dict[str, tuple[float, float]]:
    """Seconds and peak memory [MB] of each step of a command, run in this process."""
    from scarid_cli.__main__ import main as scarid

    thread, ended = threading.main_thread().ident, threading.Event()
    seconds: dict[str, float] = defaultdict(float)
    peaks: dict[str, float] = defaultdict(float)

    def look() -> None:
        before = time.process_time()
        while not ended.wait(INTERVAL):
            now, step = time.process_time(), step_of(thread or 0)
            seconds[step] += now - before
            peaks[step] = max(peaks[step], resident())
            before = now

    looking = threading.Thread(target=look)
    looking.start()
    try:
        if scarid(words):
            raise SystemExit(f"scarid {' '.join(words)} has failed")
    finally:
        ended.set()
        looking.join()
    return {step: (seconds[step], peaks[step]) for step in (*STEPS, REST) if step in seconds}


def errors(path: Path, truth: np.ndarray) -> str:
    """The errors of the estimates in a table, over those that it states."""
    import pyarrow.parquet as pq

    estimates, stated = (pq.read_table(path)[x].to_numpy() for x in ("estimate", "robust_error"))
    ratios = np.abs(estimates - truth) / stated
    worst, rms = ratios.max(), np.sqrt(np.mean(ratios**2))
    return f"rms {rms:.2f} of those stated, the largest {worst:.1f}, of {ratios.size} parameters"


def cost(text: str) -> tuple[dict[str, tuple[float, float]], str]:
    """The steps of the identification of a simulated log, in a process of its own; its errors."""
    import pyarrow as pa
    import pyarrow.parquet as pq
    from arms import URDFS, described
    from conditions import Condition, log, robot_named, truth_of

    name, duration, rate = text.split(":")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.parquet"
        condition = Condition("long", rate=float(rate), duration=float(duration))
        table = log(robot_named(name), condition, 0)
        columns = [c for c in table.columns if c == "t" or not c.endswith("_ref")]
        pq.write_table(pa.Table.from_batches(list(table.batches)).select(columns), path)
        urdf = URDFS / f"{name}.urdf"
        robot = str(described(urdf, Path(folder))) if urdf.exists() else name
        words = ["identify", "-q", "--robot", robot, str(path), "-o", f"{folder}/out.parquet"]
        command = [sys.executable, __file__, "--run", json.dumps(words)]
        out = subprocess.run(command, check=True, capture_output=True, text=True)
        off = errors(Path(folder) / "out.parquet", truth_of(robot_named(name), condition))
    return {step: tuple(x) for step, x in json.loads(out.stdout).items()}, off


def total(steps: dict[str, tuple[float, float]]) -> tuple[float, float]:
    """Seconds of all steps, and the peak memory [MB]."""
    return sum(s for s, _ in steps.values()), max(m for _, m in steps.values())


def _cell(seconds: float, megabytes: float) -> str:
    return f"{seconds:.2f} s {megabytes:.0f} MB"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", default=f"scara2:20:200,ur10:60:500,{','.join(GROWTH)}")
    parser.add_argument("--run", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        print(json.dumps(watched(json.loads(given.run))))
        return
    costs = {text: cost(text) for text in given.logs.split(",")}
    found = {text: steps for text, (steps, _) in costs.items()}
    print("step | " + " | ".join(found))
    for step in (*STEPS, REST):
        cells = [_cell(*steps[step]) if step in steps else "" for steps in found.values()]
        print(step, *cells, sep=" | ")
    print("all", *(_cell(*total(steps)) for steps in found.values()), sep=" | ")
    for text, (_, off) in costs.items():
        print(f"{text}: errors {off}")
    if set(GROWTH) <= set(found):
        (few, small), (many, large) = (total(found[text]) for text in GROWTH)
        time_grows, memory_grows = (ln(x) / ln(10.0) for x in (many / few, large / small))
        print(f"exponents: time {time_grows:.2f}, memory {memory_grows:.2f}")


if __name__ == "__main__":
    main()
