"""`scarid validate` with several parameter tables: a log is compared with all together."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from conftest import Result

Run = Callable[..., Result]


@pytest.fixture
def logs(scarid: Run, samples: Path, tmp_path: Path) -> list[Path]:
    """The folders of three parts of the sample log: its motion, and its parameters in two formats.

    The torques of joint 2 are larger by half in the last one.
    """
    header, *lines = (samples / "scara2.csv").read_text().splitlines()
    place, third = header.split(",").index("tau2"), len(lines) // 3
    found = []
    for k in range(3):
        rows = [line.split(",") for line in lines[k * third : (k + 1) * third]]
        for row in rows:
            row[place] = repr((1.5 if k == 2 else 1.0) * float(row[place]))
        folder = tmp_path / str(k)
        folder.mkdir()
        (folder / "log.csv").write_text("\n".join([header, *(",".join(row) for row in rows)]))
        motion = folder / "motion.parquet"
        assert scarid("differentiate", folder / "log.csv", "-o", motion).status == 0
        for name in ("p.parquet", "p.csv"):
            words = ("--estimator", "wls", "--align", motion, "-o", folder / name)
            assert scarid("identify", *words).status == 0
        found.append(folder)
    return found


def validated(scarid: Run, log: Path, *tables: Path) -> tuple[list[float], dict[str, Any], str]:
    """R2 of the joints, what the metadata say of a change, and the messages."""
    out = log / "metrics.parquet"
    words = [word for table in tables for word in ("--parameters", table)]
    result = scarid("validate", *words, log / "motion.parquet", "-o", out)
    assert result.status == 0, result.err
    table = pq.read_table(out)
    extra = json.loads(table.schema.metadata[b"scarid"])["extra"]
    return table.column("r2").to_pylist(), extra["change"], result.err


def simulated(scarid: Run, folder: Path, seed: int) -> Path:
    """The folder with the motion of a simulated log of ten seconds, and its parameters."""
    own = folder / f"simulated-{seed}"
    own.mkdir()
    path, log, motion = (own / f"{name}.parquet" for name in ("path", "log", "motion"))
    for words in (
        ("trajgen", "--robot", "scara2", "--seed", seed, "--duration", 10, "-o", path),
        ("simulate", "--seed", seed, path, "-o", log),
        ("differentiate", log, "-o", motion),
        ("identify", "--estimator", "wls", "--align", motion, "-o", own / "p.parquet"),
    ):
        assert scarid(*words).status == 0
    return own


def test_the_same_table_twice_predicts_what_it_predicts_once(scarid: Run, tmp_path: Path) -> None:
    """Almost: the information weighs joints by the autocorrelation of residuals, `wls` does not."""
    here, there = (simulated(scarid, tmp_path, seed) for seed in (1, 2))
    table = there / "p.parquet"
    once, _, _ = validated(scarid, here, table)
    twice, _, said = validated(scarid, here, table, table)
    assert twice == pytest.approx(once, abs=1e-5)
    assert "pooled the parameters of 2 identifications" in said
    thrice, _, _ = validated(scarid, here, *3 * [table])
    assert thrice == pytest.approx(twice, rel=1e-9)


def test_a_log_is_compared_with_all_tables_together(scarid: Run, logs: list[Path]) -> None:
    first, second, other = (folder / "p.parquet" for folder in logs)
    _, same, _ = validated(scarid, logs[0], first, second)
    assert same["verdict"] == "unchanged"
    assert "nan" not in same["reason"]
    _, changed, _ = validated(scarid, logs[2], first, second)
    assert changed["verdict"] == "changed"
    assert "joint 2" in changed["reason"]
    forth, _, _ = validated(scarid, logs[0], first, other)
    back, _, _ = validated(scarid, logs[0], other, first)
    assert forth == pytest.approx(back, abs=2e-3)


def test_tables_without_the_evidence_of_their_log_are_not_pooled(
    scarid: Run, logs: list[Path]
) -> None:
    words = ("--parameters", logs[0] / "p.parquet", "--parameters", logs[1] / "p.csv")
    result = scarid("validate", *words, logs[0] / "motion.parquet")
    assert (result.status, result.out) == (65, "")
    assert result.err.count("\n") == 1
    assert "p.csv: found no evidence of the log" in result.err
    assert "write each one with `scarid identify -o FILE.parquet`" in result.err
