"""Start-up, time per sample and peak memory of the installed scarid: `make bench`.

Each figure that depends on the speed of the machine stands beside a baseline of the same run. The
environment variable ROWS sets the length of the long streams.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import speed
from memory import SCARID, six_axes, streaming_stages

ROUNDS = 11
PREPARATION = """
{scarid} trajgen -q --duration 2 | {scarid} simulate -o log.csv &&
{scarid} differentiate log.csv -o motion.csv &&
{scarid} identify -q motion.csv -o parameters.csv
"""
Command = tuple[list[str], Path | None]  # its words, and what it reads


def startup(folder: Path) -> None:
    """Fixed cost of the commands beside that of the imports that they need, in turns."""
    script = PREPARATION.format(scarid=SCARID)
    subprocess.run(["bash", "-c", script], cwd=folder, check=True)
    runs = commands(folder)
    times: dict[str, list[float]] = {name: [] for name in runs}
    for _ in range(ROUNDS):
        for name, command in runs.items():
            times[name].append(seconds(command))
    print(f"\nStart-up, median of {ROUNDS} runs, and its ratio to the imports above it")
    base = 0.0
    for name, values in times.items():
        median = statistics.median(values)
        base = median if name.startswith("import") else base
        print(f"  {name:30} {1000 * median:7.0f} ms  {median / base:5.2f}")


def commands(folder: Path) -> dict[str, Command]:
    """What is started: imports alone, each followed by the commands that need them."""
    python = [sys.executable, "-c"]
    log, motion, parameters = (folder / f"{x}.csv" for x in ("log", "motion", "parameters"))
    return {
        "import click": ([*python, "import click"], None),
        "scarid --help": ([SCARID, "--help"], None),
        "import click, numpy, pyarrow": ([*python, "import click, numpy, pyarrow"], None),
        "scarid filter": ([SCARID, "filter"], log),
        "scarid differentiate": ([SCARID, "differentiate"], log),
        "scarid identify": ([SCARID, "identify"], motion),
        "scarid validate": ([SCARID, "validate", "--parameters", str(parameters)], motion),
    }


def seconds(command: Command) -> float:
    """Time of one run [s]."""
    words, source = command
    with (source or Path(os.devnull)).open("rb") as stdin:
        start = time.perf_counter()
        subprocess.run(
            words, stdin=stdin, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        return time.perf_counter() - start


def main() -> None:
    subprocess.run([SCARID, "--version"], check=True)
    with tempfile.TemporaryDirectory() as folder:
        startup(Path(folder))
        speed.kernels()
        speed.differentiators()
        speed.estimators()
        streaming_stages(Path(folder))
        six_axes(Path(folder))


if __name__ == "__main__":
    main()
