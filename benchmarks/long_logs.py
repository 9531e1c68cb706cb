"""Processor time and peak memory of `scarid identify` on long logs of an arm at a high rate.

    python benchmarks/long_logs.py --robot panda --rate 1000 --seconds 120,600

The arms are those of the gauntlet that are known by their URDF (`benchmarks/arms.py`).
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
from arms import ARMS, URDFS, described
from conditions import Condition, log, robot_named


def cost(command: list[str]) -> tuple[float, float]:
    """The processor time [s] and the peak memory [GB] of a command."""
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(command)}: exit status {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robot", choices=ARMS, default="panda")
    parser.add_argument("--rate", type=float, default=1000.0, help="of the log [Hz]")
    parser.add_argument("--seconds", default="120,600", help="durations of logs")
    given = parser.parse_args()
    scarid = str(Path(sys.executable).parent / "scarid")
    for seconds in map(float, given.seconds.split(",")):
        condition = Condition("long", rate=given.rate, duration=seconds)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "log.parquet"
            table = log(robot_named(given.robot), condition, 0)
            pq.write_table(pa.Table.from_batches(list(table.batches)), path)
            arm = described(URDFS / f"{given.robot}.urdf", Path(folder))
            command = [scarid, "identify", "-q", "--robot", str(arm), str(path), "-o"]
            time, memory = cost([*command, str(path.with_name("parameters.parquet"))])
        print(f"{given.robot}, {seconds:g} s at {given.rate:g} Hz: {time:.0f} s, {memory:.1f} GB")


if __name__ == "__main__":
    main()
