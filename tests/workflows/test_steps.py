"""A batch of a small simulated fleet: a row for each log, whatever becomes of it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from conftest import ROOT
from fleet import Planned, description, made
from workflows.outcomes import WORKFLOW, in_one_process

from scarid_cli.io import schemas

GOOD, LOADED = 7, 5
SPOILED = ("text", "cut", "swapped", "degrees")
LOGS = GOOD + len(SPOILED)


def logs() -> list[Planned]:
    """Those of a robot whose friction rises; one has another payload, the last ones are spoiled."""
    good = [
        Planned("robot2", k, k, friction=1.0 + 0.05 * k, payload=k == LOADED) for k in range(GOOD)
    ]
    return [*good, *(Planned("robot2", GOOD + k, k, spoil=how) for k, how in enumerate(SPOILED))]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the fleet, after its batch."""
    folder = tmp_path_factory.mktemp("fleet")
    for log in logs():
        made(folder, log)
    (folder / "robot2.toml").write_text(description("robot2"))
    config = folder / "fleet.toml"
    text = 'group = 5\npages = "none"\n[robots.arm]\nrobot = "robot2.toml"\nlogs = "logs/*/*.csv"\n'
    config.write_text(text)
    done = in_one_process(config)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return folder


@pytest.fixture
def rows(folder: Path) -> list[dict[str, Any]]:
    return pq.read_table(folder / "outcome" / "fleet.parquet").to_pylist()


@pytest.mark.parametrize("kind", ["fleet", "estimates", "robots"])
def test_the_tables_are_those_of_the_schemas(kind: str, folder: Path) -> None:
    table = pq.read_table(folder / "outcome" / f"{kind}.parquet")
    schema = schemas.load(kind)
    assert {name for name in table.column_names if not schema.field_of(name)} == set()
    assert {f.name for f in schema.fields if not f.per_joint} <= set(table.column_names)
    required = [field.name for field in schema.fields if field.required]
    assert all(table.column(name).null_count == 0 for name in required)


def test_every_log_is_a_row_in_order(rows: list[dict[str, Any]]) -> None:
    assert [row["order"] for row in rows] == [*range(1, LOGS + 1)]
    assert [row["date"] for row in rows] == [f"2026-01-{day:02d}" for day in range(1, LOGS + 1)]
    assert {row["robot"] for row in rows} == {"arm"}


def test_a_log_that_fails_is_a_row_with_its_error(rows: list[dict[str, Any]]) -> None:
    by_spoil = {log.spoil: row for log, row in zip(logs(), rows, strict=True) if log.spoil}
    for spoil in ("text", "cut"):
        row = by_spoil[spoil]
        assert (row["status"], row["verdict"], row["change"]) == (65, None, None)
        assert row["error"].startswith(f"scarid {row['step']}: ")
        assert row["file"] in row["error"]
    assert "row 2001" in by_spoil["text"]["error"]
    assert by_spoil["swapped"]["check"] == "failed"
    assert "exchanged" in by_spoil["swapped"]["findings"]
    assert by_spoil["degrees"]["check"] == "failed"


def test_a_changed_payload_and_a_drift_are_found(rows: list[dict[str, Any]], folder: Path) -> None:
    loaded = rows[LOADED]
    assert loaded["change"] == "changed"
    assert "another payload" in loaded["change_reason"]
    assert {"ZZ2", "L1MX2"} <= set(loaded["differing"].split(", "))
    robots = pq.read_table(folder / "outcome" / "robots.parquet").to_pylist()
    assert len(robots) == 1
    trending = robots[0]["trending"].split(", ")
    assert trending[0] == "Fs2"
    assert not {"ZZ1R", "ZZ2", "L1MX2"} & set(trending)
    assert robots[0]["cutoff"] > 3.0


def test_the_text_is_the_same_table(rows: list[dict[str, Any]], folder: Path) -> None:
    lines = (folder / "outcome" / "fleet.tsv").read_text().splitlines()
    assert lines[0].split("\t") == [*rows[0]]
    assert len(lines) == LOGS + 1
    assert [line.split("\t")[1] for line in lines[1:]] == [row["log"] for row in rows]


def test_the_commands_of_a_log_are_told_and_give_its_parameters(folder: Path) -> None:
    own = folder / "outcome" / "logs" / "arm" / "2026-01-01"
    lines = (own / "messages.txt").read_text().splitlines()
    typed = [line.removeprefix("$ ") for line in lines if line.startswith("$ ")]
    assert [command.split()[1] for command in typed] == ["convert", "differentiate", "validate"]
    table = pq.read_table(own / "parameters.parquet")
    estimates = pq.read_table(folder / "outcome" / "estimates.parquet").to_pylist()
    first = [row["estimate"] for row in estimates if row["log"] == "2026-01-01"]
    assert first == table.column("estimate").to_pylist()


def test_a_single_log_has_nothing_to_be_compared_with(tmp_path: Path) -> None:
    config = tmp_path / "fleet.toml"
    log = ROOT / "samples" / "scara2.csv"
    config.write_text(f'[robots.one]\nrobot = "scara2"\nlogs = "{log}"\n')
    done = in_one_process(config)
    assert (done.returncode, done.stderr) == (0, "")
    row = pq.read_table(tmp_path / "outcome" / "fleet.parquet").to_pylist()[0]
    assert (row["status"], row["verdict"], row["reference"], row["change"]) == (
        0,
        "good",
        None,
        None,
    )
    assert row["page"] == "logs/one/scara2/report.html"
    assert (tmp_path / "outcome" / row["page"]).exists()


def test_a_batch_in_which_every_log_fails_has_its_tables(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t,q1\n0,1\n")
    config = tmp_path / "fleet.toml"
    config.write_text('[robots.one]\nrobot = "scara2"\nlogs = "*.csv"\n')
    done = in_one_process(config)
    assert (done.returncode, done.stderr) == (0, "")
    out = tmp_path / "outcome"
    assert pq.read_table(out / "fleet.parquet").column("status").to_pylist() == [65]
    assert pq.read_table(out / "estimates.parquet").num_rows == 0
    words = [sys.executable, "-m", "scarid_cli", "report", "--fleet", str(out), "--html"]
    page = subprocess.run([*words, str(out / "fleet.html")], capture_output=True, check=False)
    assert (page.returncode, (out / "fleet.html").exists()) == (0, True), page.stderr


def test_a_log_that_kills_its_process_is_a_row() -> None:
    """In a process of its own, because the step forks."""
    script = """
import os, sys
sys.path.insert(0, {folder!r})
from steps.commands import of_each
def step(log):
    if log == 2:
        os.kill(os.getpid(), 9)
    if log == 4:
        raise ValueError("a mistake of the step")
    return {{"status": 0, "log": log}}
for result in of_each(step, [1, 2, 3, 4, 5]):
    print(result)
"""
    done = subprocess.run(
        [sys.executable, "-c", script.format(folder=str(WORKFLOW))],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    lines = done.stdout.splitlines()
    assert ["'log'" in line for line in lines] == [True, False, True, False, True]
    assert "ended by SIGKILL at this log" in lines[1]
    assert "'status': 137" in lines[1]
    assert "ended with status 1 at this log" in lines[3]
