"""What machines ask: a JSON document of each verdict, and an exit status that depends on it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pyarrow.parquet as pq
import pytest
from conftest import ROOT, Result

Run = Callable[..., Result]
FRICTION = ("--with", "motor-gain=0,0.1")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("gates")


@pytest.fixture
def made(folder: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A robot before and after its second motor became stronger."""
    monkeypatch.chdir(folder)
    if (folder / "after.parquet").exists():
        return folder
    for seed, (name, *more) in enumerate((("before",), ("after", *FRICTION))):
        words = ("trajgen", "-q", "--seed", seed, "then", "simulate", "-q", "--seed", seed)
        assert scarid(*words, *more, "-o", f"{name}.csv").status == 0
        assert scarid("identify", "-q", f"{name}.csv", "-o", f"{name}.parquet").status == 0
    return folder


def document(text: str) -> dict[str, Any]:
    """A document, which must be as its schema says, and JSON in the strict sense."""

    def refuse(constant: str) -> None:
        raise AssertionError(f"{constant} is no JSON")

    found: dict[str, Any] = json.loads(text, parse_constant=refuse)
    schema = json.loads(
        (ROOT / "schemas" / "documents" / f"{found['command']}.schema.json").read_text("utf-8")
    )
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(found, schema)
    return found


def test_the_document_of_identify_has_the_values_of_the_table(made: Path, scarid: Run) -> None:
    result = scarid("identify", "--json", "before.csv", "-o", "again.parquet")
    found, table = document(result.out), pq.read_table("again.parquet")
    assert found["verdict"] == "good"
    assert found["estimator"] == "gls"
    assert [p["estimate"] for p in found["parameters"]] == table.column("estimate").to_pylist()
    for row in found["parameters"]:
        assert row["half_interval"] == pytest.approx(0.5 * (row["high"] - row["low"]))
    assert [joint["joint"] for joint in found["joints"]] == [1, 2]
    for key, words in (("torque", "model torque within"), ("inertia", "inertia within")):
        parts = (100.0 * joint[f"{key}_half_interval"] for joint in found["joints"])
        told = ", ".join(f"joint {i} {part:.2g} %" for i, part in enumerate(parts, start=1))
        assert f"{words} {told}" in found["reasons"][0]
    alone = scarid("identify", "--json", "before.csv")
    assert document(alone.out) == found


def test_a_document_of_numbers_that_are_not_known_is_strict_json(
    made: Path, scarid: Run, tmp_path: Path
) -> None:
    """A log in which joint 2 stands still leaves parameters without an interval."""
    words = ("trajgen", "-q", "--ddq-max", "20,0.001", "then", "simulate", "-q")
    log = tmp_path / "still.csv"
    assert scarid(*words, "-o", log).status == 0
    document(scarid("differentiate", log, "then", "identify", "--json").out)


@pytest.mark.parametrize(
    ("log", "verdict", "status"), [("before", "unchanged", 0), ("after", "changed", 3)]
)
def test_validate_is_a_gate(log: str, verdict: str, status: int, made: Path, scarid: Run) -> None:
    words = ("validate", "-q", "--parameters", "before.parquet", f"{log}.csv")
    result = scarid(*words, "--json", "--require", "unchanged")
    assert result.status == status
    assert document(result.out)["verdict"] == verdict
    line = "scarid validate: the verdict is changed, not unchanged as --require asks\n"
    assert result.err == (line if status else "")
    written = scarid(*words, "--require", "unchanged", "-o", "metrics.parquet")
    assert written.status == status
    assert pq.read_table("metrics.parquet").num_rows == 2


def test_validate_names_the_kind_of_change(made: Path, scarid: Run) -> None:
    words = ("validate", "-q", "--json", "--parameters", "before.parquet", "after.csv")
    found = document(scarid(*words).out)
    assert [(e["kind"], e["joints"]) for e in found["explanations"]] == [("motor constant", [2])]


def test_without_a_verdict_nothing_is_unchanged(made: Path, scarid: Run) -> None:
    """A CSV carries no evidence of the identification."""
    bare = "parameter,unit,estimate\n" + "".join(
        f"{row['parameter']},{row['unit']},{row['estimate']!r}\n"
        for row in pq.read_table("before.parquet").to_pylist()
    )
    Path("bare.csv").write_text(bare)
    words = ("validate", "-q", "--parameters", "bare.csv", "before.csv", "--robot", "scara2")
    result = scarid(*words, "--require", "unchanged")
    assert result.status == 3
    assert "there is no verdict" in result.err


@pytest.mark.parametrize(
    ("tables", "verdict", "status"),
    [
        (("before", "before"), "same", 0),
        (("before", "after"), "differ", 3),
        (("before", "before", "after"), "differ", 3),
    ],
)
def test_compare_is_a_gate(
    tables: tuple[str, ...], verdict: str, status: int, made: Path, scarid: Run
) -> None:
    files = [f"{name}.parquet" for name in tables]
    for i, file in enumerate(files):
        if file in files[:i]:
            Path(f"copy{i}.parquet").write_bytes(Path(file).read_bytes())
            files[i] = f"copy{i}.parquet"
    result = scarid("compare", "-q", "--json", "--require", "same", *files)
    assert result.status == status
    found = document(result.out)
    assert found["verdict"] == verdict
    assert len(found["comparisons"]) == len(tables) - 1
    assert (found["trend"] is not None) == (len(tables) > 2)
    assert result.err.count("\n") == (1 if status else 0)


def test_a_quiet_gate_of_identify_says_one_line(made: Path, scarid: Run) -> None:
    words = (
        "differentiate",
        "--method",
        "backward",
        "--no-match",
        "before.csv",
        "then",
        "identify",
        "-q",
    )
    result = scarid(*words, "--require", "good")
    assert result.status == 3
    assert result.err.count("\n") == 1
    assert "worse than --require good" in result.err


def test_a_document_is_no_table(made: Path, scarid: Run) -> None:
    result = scarid("identify", "--json", "before.csv", "then", "tee", "x.csv")
    assert (result.status, result.out) == (2, "")
    assert not Path("x.csv").exists()
