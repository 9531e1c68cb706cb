"""What identify and validate give for logs under all conditions, to compare two versions by bytes.

    python benchmarks/same.py build/before         # at one commit
    python benchmarks/same.py build/after          # at another one
    diff -r build/before build/after

A file for each condition of the gauntlet, with one of its robots: what `identify` writes to
standard error and to its table, with the metadata, the text of `report`, and what `validate` says
of the log with the parameters of a clean one.

So it is seen that a change of the code's structure changes nothing, and which logs one of the
statistics concerns.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import pyarrow as pa
import pyarrow.parquet as pq
from conditions import CONDITIONS, UNSEEN, Condition, log, robot_named

ROBOTS = ("scara2", "planar2-gravity")
SEED = 5000
PARAMETERS = "parameters.parquet"


def scarid(folder: Path, *words: str) -> str:
    """What a command prints to both streams, and its exit status."""
    command = [sys.executable, "-m", "scarid_cli", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return f"{done.stderr}{done.stdout}status {done.returncode}\n"


def told(folder: Path, robot: str, condition: Condition, seed: int) -> str:
    """All that is said of a log, whose files stand in this folder."""
    batches = [
        b.replace_schema_metadata(None) for b in log(robot_named(robot), condition, seed).batches
    ]
    pq.write_table(pa.Table.from_batches(batches), folder / "log.parquet")
    text = scarid(folder, "identify", "--robot", robot, "log.parquet", "-o", PARAMETERS)
    if not (folder / PARAMETERS).exists():
        return text
    table = pq.read_table(folder / PARAMETERS)
    facts = json.loads(table.schema.metadata[b"scarid"])
    facts.pop("history", None)
    text += scarid(folder, "report", PARAMETERS)
    return text + json.dumps([table.to_pylist(), facts], indent=0, sort_keys=True)


def case(out: Path, clean: dict[str, Path], one: tuple[str, Condition, int]) -> None:
    """The file of a condition."""
    robot, condition, seed = one
    with TemporaryDirectory() as folder:
        text = told(Path(folder), robot, condition, seed)
        text += scarid(Path(folder), "validate", "--parameters", str(clean[robot]), "log.parquet")
    (out / f"{robot}, {condition.name}.txt").write_text(text, "utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--conditions", default="", help="only those with this in their name")
    given = parser.parse_args()
    given.out.mkdir(parents=True)
    every = list(enumerate(CONDITIONS + UNSEEN))
    cases = [(ROBOTS[k % 2], x, SEED + k) for k, x in every if given.conditions in x.name]
    with TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        clean = {robot: Path(folder) / robot / PARAMETERS for robot in ROBOTS}
        for robot, path in clean.items():
            path.parent.mkdir()
            told(path.parent, robot, CONDITIONS[0], SEED)
        list(pool.map(partial(case, given.out, clean), cases))


if __name__ == "__main__":
    main()
