"""Peak memory of the streaming stages, which must not depend on the length of the log."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

SCARID = str(Path(sys.executable).parent / "scarid")
STREAMS = [sys.executable, str(Path(__file__).with_name("streams.py"))]
SHORT, LONG = 100_000, int(os.environ.get("ROWS", "10_000_000"))
SHORT_OF_SIX, LONG_OF_SIX = 50_000, 1_000_000
# The peak memory of a process includes that of its parent at the fork: the parent must be small.
LAUNCHER = """
import resource, subprocess, sys
subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)
"""
AXES = ("0 0 1", "0 1 0", "0 1 0", "1 0 0", "0 1 0", "1 0 0")
JOINT = (
    '<joint name="j{i}" type="revolute"><parent link="link{before}"/><child link="link{i}"/>'
    '<origin xyz="0.2 0 0.1"/><axis xyz="{axis}"/>'
    '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
    '<link name="link{i}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0"'
    ' iyy="1" iyz="0" izz="1"/></inertial></link>'
)


def measured(source: list[str], stage: list[str]) -> tuple[float, float]:
    """Peak memory [MB] and time [s] of a stage that reads what the source writes."""
    with subprocess.Popen(source, stdout=subprocess.PIPE) as upstream:
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", LAUNCHER, *stage],
            stdin=upstream.stdout,
            capture_output=True,
            check=True,
        )
    return int(done.stderr.split()[-1]) / 1024, time.perf_counter() - start


def peak(words: list[str], rows: int) -> tuple[float, float]:
    """Peak memory [MB] and time [s] of a stage that reads a motion of so many rows."""
    return measured([*STREAMS, "motion", str(rows)], [SCARID, *words])


def stages(folder: Path) -> dict[str, list[str]]:
    """The streaming stages, by name; their parameters are identified into the folder."""
    parameters = folder / "p.csv"
    peak(["identify", "-q", "-o", str(parameters)], 2000)
    return {
        "resample": ["resample", "-q", "--rate", "60", "--format", "arrow"],
        "filter": ["filter", "--format", "arrow"],
        "differentiate": ["differentiate", "--format", "arrow"],
        "identify": ["identify", "-q"],
        "validate": ["validate", "--parameters", str(parameters)],
    }


def streaming_stages(folder: Path) -> None:
    """Peak memory on a short and on a long stream."""
    print(f"\nPeak memory on Arrow streams of {SHORT:,} and {LONG:,} rows, and time per row")
    for name, words in stages(folder).items():
        show(name, peak(words, SHORT), peak(words, LONG), LONG)


def show(name: str, short: tuple[float, float], long: tuple[float, float], rows: int) -> None:
    """One line of the table; `rows` is the number of rows of the long stream."""
    print(
        f"  {name:30} {short[0]:6.1f} MB {long[0]:6.1f} MB  ratio {long[0] / short[0]:5.3f}"
        f"  {long[1] / rows * 1e6:6.2f} us per row"
    )


def six_axes(folder: Path) -> None:
    """A log of six axes through filter, differentiate and identify, with the robot from a URDF."""
    robot = folder / "arm.urdf"
    joints = (JOINT.format(i=i, before=i - 1, axis=axis) for i, axis in enumerate(AXES, start=1))
    robot.write_text(f'<robot name="arm"><link name="link0"/>{"".join(joints)}</robot>')
    print(
        f"\nSix axes: peak memory of the last stage on {SHORT_OF_SIX:,} and {LONG_OF_SIX:,} rows, "
        "and time per row"
    )
    filtered = f"{' '.join(STREAMS)} six-axes {{rows}} | {SCARID} filter --format arrow"
    differentiate = [SCARID, "differentiate", "--format", "arrow"]
    identify = [SCARID, "identify", "-q", "--robot", str(robot)]
    for name, pipe, last in (
        ("filter | differentiate", filtered, differentiate),
        ("... | identify, 61 parameters", f"{filtered} | {' '.join(differentiate)}", identify),
    ):
        short, long = (
            measured(["bash", "-c", pipe.format(rows=rows)], last)
            for rows in (SHORT_OF_SIX, LONG_OF_SIX)
        )
        show(name, short, long, LONG_OF_SIX)
