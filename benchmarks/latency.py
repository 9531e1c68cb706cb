"""From a row written to its estimates read, with rows that arrive one at a time.

`python benchmarks/latency.py [HZ]`: the median and the 95 and 99 % quantiles over some
seconds, in ms, of pipes whose last command writes a row for each row that arrives. The robot is
scara2, the motion that of a simulated log. Three times `cat` is what the machine itself takes.
"""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

SCARID = f"{Path(sys.executable).parent}/scarid"
TRACE = "identify -q --robot scara2 --trace - -o parameters.csv"
PIPES = {
    "cat | cat | cat": ("cat", "cat", "cat"),
    "filter": ("filter -q",),
    "differentiate": ("differentiate -q",),
    "filter | differentiate | identify, CSV": ("filter -q", "differentiate -q", TRACE),
    "CSV, --all-rows": ("filter -q", "differentiate -q", f"{TRACE} --all-rows"),
    "the same, Arrow": (
        "filter -q --format arrow",
        "differentiate -q --format arrow",
        TRACE,
    ),
    "the same, then": (f"filter -q - then differentiate -q then {TRACE}",),
    "Arrow, --all-rows": (
        "filter -q --format arrow",
        "differentiate -q --format arrow",
        f"{TRACE} --all-rows",
    ),
    "then, --all-rows": (f"filter -q - then differentiate -q then {TRACE} --all-rows",),
}
SECONDS = 4.0


def log(folder: Path, hertz: float) -> list[str]:
    """The lines of a simulated log at this rate."""
    path = folder / "log.csv"
    rate = f"--log-rate {hertz:g}"
    line = f"{SCARID} trajgen -q --seed 1 | {SCARID} simulate -q {rate} | cut -d, -f1-5 > {path}"
    subprocess.run(line, shell=True, check=True)
    return path.read_text().splitlines(keepends=True)


def delays(line: str, rows: list[str], hertz: float, folder: Path) -> Iterator[float]:
    """The time from each row written to its row read [s], after the first second."""
    process = subprocess.Popen(
        line, shell=True, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdin
    assert process.stdout
    sent: dict[str, float] = {}
    process.stdin.write(rows[0])

    def produce() -> None:
        assert process.stdin
        begun = time.monotonic() + 2.0  # the commands start
        for k, row in enumerate(rows[1 : 1 + int((SECONDS + 1.0) * hertz)]):
            time.sleep(max(0.0, begun + k / hertz - time.monotonic()))
            sent[row.split(",")[0]] = time.monotonic()
            process.stdin.write(row)
            process.stdin.flush()
        process.stdin.close()

    producer = threading.Thread(target=produce)
    producer.start()
    for read in process.stdout:
        arrived = time.monotonic()
        t = read.split(",")[0]
        if t in sent and float(t) > 1.0:
            yield arrived - sent[t]
    producer.join()
    process.wait()


def main() -> None:
    import tempfile

    hertz = float(sys.argv[1]) if len(sys.argv) > 1 else 200.0
    sys.setswitchinterval(1e-4)  # of the threads that write and read
    print(f"rows at {hertz:g} Hz: median, 95 and 99 % quantiles [ms], rows")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        rows = log(folder, hertz)
        for title, commands in PIPES.items():
            line = " | ".join(x if x == "cat" else f"{SCARID} {x}" for x in commands)
            found = 1e3 * np.array([*delays(line, rows, hertz, folder)])
            middle, most, worst = np.quantile(found, (0.5, 0.95, 0.99))
            cells = f"{middle:7.2f} {most:7.2f} {worst:7.2f}"
            print(f"  {title:<40} {cells} {len(found):6}", flush=True)


if __name__ == "__main__":
    main()
