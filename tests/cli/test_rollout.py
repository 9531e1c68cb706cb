"""`validate --rollout`: what the identified model predicts of the motion."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from conftest import Result

Run = Callable[..., Result]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("rollout")


@pytest.fixture
def made(folder: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(folder)
    if not (folder / "second.parquet").exists():
        for seed, name in ((1, "first"), (2, "second")):
            words = ("trajgen", "-q", "--robot", "scara2", "--seed", seed)
            assert scarid(*words, "then", "simulate", "-q", "-o", f"{name}.parquet").status == 0
        assert scarid("identify", "-q", "first.parquet", "-o", "p.parquet").status == 0
    return folder


def horizons(scarid: Run, *words: object) -> list[dict[str, list[float]]]:
    found = scarid("validate", "--json", "--parameters", *words, "-o", "m.parquet")
    assert found.status == 0
    return list(json.loads(found.out)["rollout"]["horizons"])


def test_the_model_is_far_better_than_a_constant_velocity(made: Path, scarid: Run) -> None:
    for found in horizons(scarid, "p.parquet", "second.parquet", "--rollout", 0.4):
        error, steady = (np.array(found[x]) for x in ("error", "of_constant_velocity"))
        assert (error < 0.1 * steady).all()
        assert (error < 0.02 * np.array(found["movement"])).all()


def test_a_wrong_model_is_told_by_its_positions(made: Path, scarid: Run) -> None:
    """Of a motor constant 20 % off, accelerations are off as well."""
    words = ("trajgen", "-q", "--robot", "scara2", "--seed", 2, "then", "simulate", "-q")
    assert scarid(*words, "--with", "torque-constant-error=0.2", "-o", "off.parquet").status == 0
    right, wrong = (
        horizons(scarid, "p.parquet", log, "--rollout", 0.4)[-1]
        for log in ("second.parquet", "off.parquet")
    )
    assert (np.array(wrong["error"]) > 5.0 * np.array(right["error"])).all()


def test_a_pipe_gives_what_the_file_gives(made: Path, scarid: Run) -> None:
    assert scarid("differentiate", "-q", "second.parquet", "-o", "motion.parquet").status == 0
    pq.write_table(pq.read_table("motion.parquet"), "small.parquet", row_group_size=13)
    whole, parts = (
        horizons(scarid, "p.parquet", name, "--rollout", 0.3)
        for name in ("motion.parquet", "small.parquet")
    )
    assert whole == parts


def test_the_lines_name_horizon_and_joints(made: Path, scarid: Run) -> None:
    found = scarid("validate", "--parameters", "p.parquet", "second.parquet", "--rollout", 0.4)
    assert "rollout: after 0.4 s the positions are off by joint 1 " in found.err
    assert "measured states, by the measured torques" in found.err


@pytest.mark.parametrize(("seconds", "says"), [(0.001, "give a longer one"), (100, "no window")])
def test_windows_that_do_not_fit(made: Path, scarid: Run, seconds: float, says: str) -> None:
    found = scarid("validate", "--parameters", "p.parquet", "second.parquet", "--rollout", seconds)
    assert says in found.err
