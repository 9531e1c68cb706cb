"""What `scarid check` says of logs with a known fault, and of clean ones: `make bench-checks`.

The clean logs are simulated with the encoders and the noise of their descriptions. Each is spoiled
in one way, see `spoiled.py`. docs/known-faults.md has the first four columns of the printed table,
and says below it what is in the last one.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from spoiled import SPOILED, Spoiled

from scarid_cli.__main__ import main
from scarid_cli.algorithms.checks.finding import OK, Finding
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.robots.reading import load
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.reader import open_table
from scarid_cli.stages.check import check
from scarid_cli.stages.records.logs import log_of

ROOT = Path(__file__).parent.parent
URDF = ROOT.parent / "shared" / "data" / "urdf"
UR10 = URDF / "ur10.urdf"
ROBOTS = {
    "scara": "scara2",
    "emps": "emps",
    "arm": str(ROOT / "samples" / "arm.toml"),
    "pendulum": "planar2-gravity",
    "ur10": str(UR10),
    "ur10e": str(ROOT / "samples" / "robots" / "ur10e.toml"),
    "panda": str(URDF / "panda.urdf"),
}
LOGS = {
    "scara": "SCARA",
    "emps": "one axis",
    "arm": "vertical arm",
    "pendulum": "pendulum",
    "ur10": "UR10",
}
SPECIAL = {
    "ur10": ["--ddq-max", "5"],
    "panda": ["--ddq-max", "5"],
    "pendulum": ["--q-max", "1.5", "--dq-max", "10", "--ddq-max", "60"],
}


def read(path: Path, robot: str) -> Log:
    """A log in a file."""
    source = ByteSource.open(str(path))
    try:
        return log_of(open_table(source), len(load(robot).joints))
    finally:
        source.close()


@cache
def clean(name: str, seed: int = 1, *more: str) -> Log:
    """A simulated log of a robot, with more options of `simulate`."""
    words = ["-q", "--robot", ROBOTS[name]]
    with TemporaryDirectory() as folder:
        path, log = Path(folder) / "reference.parquet", Path(folder) / "log.parquet"
        given = ["--seed", str(seed), *SPECIAL.get(name, [])]
        assert main(["trajgen", *words, *given, "-o", str(path)]) == 0
        assert main(["simulate", *words, *more, str(path), "-o", str(log)]) == 0
        return read(log, ROBOTS[name])


def remarks(fault: Spoiled, seed: int = 1) -> list[Finding]:
    """What is not in order in a log with this fault."""
    return of_log(fault.spoil(clean(fault.source, seed)), fault.robot or fault.source)


def of_log(log: Log, robot: str) -> list[Finding]:
    """What is not in order in a log of this robot."""
    return [found for found in check(log, load(ROBOTS[robot])) if found.status != OK]


def named(fault: Spoiled, found: list[Finding]) -> bool:
    """Whether one of the findings names the fault."""
    return any(f.name == fault.check and fault.says in f"{f.figure}; {f.advice}" for f in found)


def line(name: str, fault: Spoiled, found: list[Finding]) -> str:
    """The row of the table for a fault: the finding that names it, and the other ones."""
    own = [f"{f.status}: {f.figure}" for f in found if f.name == fault.check]
    others = ", ".join(f.name for f in found if f.name != fault.check) or "-"
    mark = "yes" if named(fault, found) else "**no**"
    cells = (name, LOGS[fault.source], fault.check, *own, mark, others)
    return f"| {' | '.join(cells)} |"


def table() -> list[str]:
    """The table of all faults whose robots are here."""
    rows = ["| fault | log | check | what it says | named | also |", "|---|---|---|---|---|---|"]
    for name, fault in SPOILED.items():
        if fault.source != "ur10" or UR10.exists():
            rows.append(line(name, fault, remarks(fault)))
    return rows


if __name__ == "__main__":
    print(*table(), sep="\n")
