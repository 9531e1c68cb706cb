"""`identify --friction auto`: friction beyond the robot's, chosen by parts that are left out."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest
from conftest import Result

Run = Callable[..., Result]
BOTH = ("--with", "friction-asymmetry=0.2", "--with", "load-friction=0.03")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("friction")


@pytest.fixture
def made(folder: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two logs of a robot with more friction than described, and one without."""
    monkeypatch.chdir(folder)
    if not (folder / "clean.parquet").exists():
        for seed, name, more in ((1, "first", BOTH), (2, "second", BOTH), (3, "clean", ())):
            words = ("trajgen", "-q", "--robot", "scara2", "--seed", seed, "then", "simulate")
            assert scarid(*words, "-q", "--seed", seed, *more, "-o", f"{name}.parquet").status == 0
    return folder


def chosen(scarid: Run, log: str, *more: object) -> tuple[list[dict[str, Any]], str]:
    found = scarid("identify", "--json", "--friction", "auto", log, "-o", "p.parquet", *more)
    assert found.status == 0
    return json.loads(found.out)["friction"], found.err


def test_what_the_robot_has_is_chosen_and_predicts_another_log(made: Path, scarid: Run) -> None:
    found, told = chosen(scarid, "first.parquet")
    kept = {(x["name"], x["joint"]) for x in found if x["kept"]}
    fitted = {
        (x["name"], x["joint"] + 1)
        for x in json.loads(pq.read_schema("p.parquet").metadata[b"scarid"])["extra"]["additions"]
    }
    assert {("offset", 1), ("offset", 2)} <= kept
    assert {("load", 1), ("load", 2)} <= fitted
    assert "offset or asymmetric Coulomb friction of joint 2 (" in told
    for x in found:
        assert not x["kept"] or x["lower"] > x["half_interval"] > 0.0
    assert scarid("identify", "-q", "first.parquet", "-o", "plain.parquet").status == 0
    errors = []
    for name in ("plain", "p"):
        words = ("validate", "-q", "--parameters", f"{name}.parquet", "second.parquet")
        assert scarid(*words, "-o", "m.parquet").status == 0
        errors.append(pq.read_table("m.parquet").column("relative_error").to_numpy())
    plain, auto = errors
    assert np.all(auto < 0.75 * plain)
    assert auto.max() < 1.1  # a robot without more friction than described has 0.8 to 0.9 %


def test_nothing_is_chosen_where_there_is_nothing(made: Path, scarid: Run) -> None:
    found, told = chosen(scarid, "clean.parquet")
    assert found
    assert not any(x["kept"] for x in found)
    assert "none beside that of the robot; not worth it: " in told
    assert scarid("identify", "-q", "clean.parquet", "-o", "plain.parquet").status == 0
    assert pq.read_table("p.parquet").equals(pq.read_table("plain.parquet"))


def test_a_motion_needs_the_delay(made: Path, scarid: Run) -> None:
    assert scarid("differentiate", "-q", "first.parquet", "-o", "motion.parquet").status == 0
    refused = scarid("identify", "--friction", "auto", "motion.parquet")
    assert refused.status == 2
    assert "--friction auto needs the delay of the torques: give --align" in refused.err
    found, _ = chosen(scarid, "motion.parquet", "--align", "--estimator", "gls")
    assert any(x["kept"] for x in found)
