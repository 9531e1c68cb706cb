"""One log, or several pooled, to validate others against: `python benchmarks/references.py`.

Logs of the first robot of the simulated fleet, unchanged, with a part of the payload, or with more
friction, are validated against those nearest to the median of a few unchanged ones.
"""

from __future__ import annotations

import contextlib
import io
import json
import random
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import fleet
import pyarrow.parquet as pq
from fleet import Planned, description, made

sys.path.insert(0, str(Path(__file__).parent.parent / "workflow"))
from steps.plan import Log
from steps.reference import Entry, _nearest

from scarid_cli.__main__ import main

WHOLE = dict(fleet.LOAD)
UNCHANGED, CHANGED = 40, 20  # logs of each kind
DRAWS, AMONG = 20, 12  # sets of unchanged logs, and the logs of a set
POOLED = (1, 2, 4)
KINDS = {
    "unchanged": (0.0, 1.0),
    "2 % of the payload": (0.02, 1.0),
    "5 % of the payload": (0.05, 1.0),
    "friction 1 % higher": (0.0, 1.01),
}


def scarid(*words: object) -> None:
    """Run a command in this process."""
    with contextlib.redirect_stderr(io.StringIO()) as said:
        status = main([str(word) for word in words])
    if status:
        raise RuntimeError(said.getvalue())


def identified(folder: Path, kind: str, seed: int) -> Entry:
    """Simulate a log, and identify its parameters; its name is the folder of its tables."""
    part, friction = KINDS[kind]
    fleet.LOAD.update({name: part * value for name, value in WHOLE.items()})
    log = Planned("robot1", seed, seed, friction=friction, payload=part > 0.0)
    made(folder, log)
    own = folder / str(seed)
    own.mkdir()
    robot = ("--robot", folder / "robot1.toml")
    scarid("differentiate", "-q", folder / "logs" / log.name, "-o", own / "m.parquet")
    words = ("--estimator", "wls", "--align", own / "m.parquet", "-o", own / "p.parquet")
    scarid("identify", "-q", *robot, *words)
    table = pq.read_table(own / "p.parquet")
    extra = json.loads(table.schema.metadata[b"scarid"])["extra"]
    found = {"check": "ok", "verdict": extra["verdict"], "estimates": table.to_pylist()}
    return Log(str(own), str(own), None, seed), found


def called(folder: Path, log: str, against: list[str]) -> str:
    """What `validate` says of a log, in a word or two."""
    tables = [word for name in against for word in ("--parameters", f"{name}/p.parquet")]
    out = folder / "metrics.parquet"
    scarid("validate", "-q", *tables, "--robot", folder / "robot1.toml", f"{log}/m.parquet",
           "-o", out)  # fmt: skip
    extra: dict[str, Any] = json.loads(pq.read_schema(out).metadata[b"scarid"])["extra"]["change"]
    reason = str(extra["reason"]).split(" (")[0].split(" of ")[0]
    return reason if extra["verdict"] == "changed" else str(extra["verdict"])


def study(folder: Path) -> None:
    (folder / "robot1.toml").write_text(description("robot1"))
    entries = {
        kind: [identified(folder, kind, 1000 * k + i)
               for i in range(CHANGED if k else UNCHANGED)]
        for k, kind in enumerate(KINDS)
    }  # fmt: skip
    counts: dict[tuple[str, int], Counter[str]] = {}
    rng = random.Random(1)
    for _ in range(DRAWS):
        among = rng.sample(entries["unchanged"], AMONG)
        nearest = [log.name for log in _nearest(among)]
        for kind in KINDS:
            others = [log.name for log, _ in entries[kind] if log.name not in nearest]
            for log in rng.sample(others, 5):
                for pooled in POOLED:
                    said = called(folder, log, nearest[:pooled])
                    counts.setdefault((kind, pooled), Counter())[said] += 1
    for kind in KINDS:
        print(f"{kind}, {DRAWS * 5} logs")
        for pooled in POOLED:
            listed = ", ".join(f"{n} {said}" for said, n in counts[kind, pooled].most_common())
            print(f"  against {pooled}: {listed}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        study(Path(temporary))
