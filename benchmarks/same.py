"""What identify and validate give for logs under all conditions, to compare two versions.

    python benchmarks/same.py build/before         # at one commit
    python benchmarks/same.py build/after          # at another one
    python benchmarks/same.py --compare build/before build/after

A file for each condition of the gauntlet, with one of its robots: what `identify` writes to
standard error and to its table, with the metadata, the text of `report`, and what `validate` says
of the log with the parameters of a clean one. The comparison counts those that are equal in all
bytes, and lists those with another verdict, with other sentences, or with an estimate or an error
that is another one by more than a hundredth of the error.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from conditions import CONDITIONS, UNSEEN, Condition, log, robot_named

ROBOTS = ("scara2", "planar2-gravity")
SEED = 5000
OWN, CLEAN = "parameters.parquet", "clean.parquet"  # of the log, of a clean one
MOVED = 0.01  # of the error


def scarid(folder: Path, *words: str) -> str:
    """What a command prints to both streams, and its exit status."""
    command = [sys.executable, "-m", "scarid_cli", *words]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return f"{done.stderr}{done.stdout}status {done.returncode}\n"


def told(folder: Path, robot: str, condition: Condition, seed: int) -> dict[str, Any]:
    """All that is said of a log, whose files stand in this folder."""
    recorded = log(robot_named(robot), condition, seed).batches
    bare = pa.Table.from_batches([batch.replace_schema_metadata(None) for batch in recorded])
    pq.write_table(bare, folder / "log.parquet")
    said = {"identify": scarid(folder, "identify", "--robot", robot, "log.parquet", "-o", OWN)}
    if not (folder / OWN).exists():
        return said
    table = pq.read_table(folder / OWN)
    facts = json.loads(table.schema.metadata[b"scarid"])
    facts.pop("history", None)
    return {
        **said,
        "report": scarid(folder, "report", OWN),
        "rows": table.to_pylist(),
        "facts": facts,
    }


def case(out: Path, clean: dict[str, Path], one: tuple[str, Condition, int]) -> None:
    """The file of a condition."""
    robot, condition, seed = one
    with TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(clean[robot], folder / CLEAN)
        said = told(folder, robot, condition, seed)
        said["validate"] = scarid(folder, "validate", "--parameters", CLEAN, "log.parquet")
    path = out / f"{robot}, {condition.name}.json"
    path.write_text(json.dumps(said, indent=0, sort_keys=True), "utf-8")


def written(out: Path, conditions: str) -> None:
    """Write the files of all conditions with this in their name."""
    out.mkdir(parents=True)
    every = list(enumerate(CONDITIONS + UNSEEN))
    cases = [(ROBOTS[k % 2], x, SEED + k) for k, x in every if conditions in x.name]
    with TemporaryDirectory() as folder, ThreadPoolExecutor(2) as pool:
        clean = {robot: Path(folder) / robot / OWN for robot in ROBOTS}
        for robot, path in clean.items():
            path.parent.mkdir()
            told(path.parent, robot, CONDITIONS[0], SEED)
        list(pool.map(partial(case, out, clean), cases))


def differences(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """What differs between the two files of a log, in words."""
    found = []
    grades = [x.get("facts", {}).get("extra", {}).get("verdict") for x in (one, other)]
    if grades[0] != grades[1]:
        found.append(f"{grades[0]} became {grades[1]}")
    found += [
        f"another text of {x}"
        for x in ("identify", "report", "validate")
        if one.get(x) != other.get(x)
    ]
    pairs = zip(one.get("rows", []), other.get("rows", []), strict=False)
    moved = [
        (abs(a[name] - b[name]) / a["robust_error"], a["parameter"], name)
        for a, b in pairs
        for name in ("estimate", "robust_error")
        if a["robust_error"] and b[name] is not None
    ]
    size, parameter, name = max(moved, default=(0.0, "", ""))
    if size > MOVED:
        found.append(
            f"the {name.replace('_', ' ')} of {parameter} moved by {size:.2g} of its error"
        )
    return found


def compared(before: Path, after: Path) -> None:
    """Print which logs differ."""
    files = sorted(path.name for path in before.glob("*.json"))
    texts = {
        name: [(folder / name).read_text("utf-8") for folder in (before, after)] for name in files
    }
    print(f"{sum(a == b for a, b in texts.values())} of {len(files)} are equal in all bytes")
    for name, pair in texts.items():
        if found := differences(*map(json.loads, pair)):
            print(f"{name.removesuffix('.json')}: {'; '.join(found)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--compare", action="store_true", help="two folders")
    parser.add_argument("--conditions", default="", help="only those with this in their name")
    given = parser.parse_args()
    if given.compare:
        compared(*given.folders)
    else:
        written(given.folders[0], given.conditions)


if __name__ == "__main__":
    main()
