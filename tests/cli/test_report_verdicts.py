"""Reports say what validate and compare have found as prominently as what identify has."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

import pytest
from conftest import Result

Run = Callable[..., Result]
PAYLOAD = "payload=0.3,0.1,0,0,0.001,0,0,0.001,0,0.001,0"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("changed")


@pytest.fixture
def made(folder: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A robot that was identified on may.csv; june.csv has a payload, and july.csv none."""
    monkeypatch.chdir(folder)
    if (folder / "c.parquet").exists():
        return folder
    for seed, (log, *more) in enumerate(
        (("may.csv",), ("june.csv", "--with", PAYLOAD), ("july.csv",))
    ):
        words = ("trajgen", "-q", "--seed", seed, "then", "simulate", "-q", "--seed", seed)
        assert scarid(*words, *more, "-o", log).status == 0
    for log, name in (("may", "p"), ("june", "loaded")):
        assert scarid("identify", "-q", f"{log}.csv", "-o", f"{name}.parquet").status == 0
    for log in ("june", "july"):
        words = ("validate", "-q", "--parameters", "p.parquet", f"{log}.csv")
        assert scarid(*words, "-o", f"{log}.parquet").status == 0
    assert scarid("compare", "-q", "p.parquet", "loaded.parquet", "-o", "c.parquet").status == 0
    return folder


def first_screen(page: Path) -> str:
    """The words above the contents of a page."""
    head = page.read_text("utf-8").partition("<nav")[0].partition("<header")[2]
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", head)).split())


def test_a_page_says_that_the_robot_has_changed(made: Path, scarid: Run) -> None:
    out = scarid("report", "p.parquet", "june.parquet", "--html", "page.html").out
    found = first_screen(made / "page.html")
    assert "changed The robot of june.csv has changed" in found
    assert "Has the robot changed? Yes. june.csv beside p.parquet: another payload" in found
    assert "Not for june.csv, which is changed." in found
    rows = [re.split(r" {2,}", line) for line in out.splitlines()]
    assert [row[1] for row in rows if row[0] == "june.csv beside p.parquet"] == ["changed"]


def test_a_page_says_that_the_robot_is_unchanged(made: Path, scarid: Run) -> None:
    scarid("report", "p.parquet", "july.parquet", "--html", "page.html")
    found = first_screen(made / "page.html")
    assert found.startswith("Identification of scara2") or "Identification of scara2" in found
    assert "good The estimates of p are good" in found
    assert "Has the robot changed? No. july.csv beside p.parquet:" in found


def test_the_worst_of_several_validations_comes_first(made: Path, scarid: Run) -> None:
    words = ("p.parquet", "july.parquet", "june.parquet")
    scarid("report", *words, "--html", "page.html")
    found = first_screen(made / "page.html")
    assert "The robot of june.csv has changed" in found
    assert "(1 of 2 are unchanged.)" in found


def test_a_comparison_is_reported(made: Path, scarid: Run) -> None:
    out = scarid("report", "c.parquet", "--html", "page.html").out
    assert "loaded.parquet beside p.parquet" in out
    assert "differ" in out
    scarid("report", "p.parquet", "c.parquet", "--html", "page.html")
    assert "loaded.parquet and p.parquet differ" in first_screen(made / "page.html")


def test_torques_belong_to_the_parameters_that_predicted_them(made: Path, scarid: Run) -> None:
    """The only identification of the report did not predict them."""
    scarid("report", "loaded.parquet", "june.parquet", "--html", "page.html")
    found = first_screen(made / "page.html")
    assert "It predicts the torques" not in found
    assert "for the robot as it was when it was identified. june.csv is changed." in found
    scarid("report", "p.parquet", "june.parquet", "--html", "page.html")
    assert "It predicts the torques" in first_screen(made / "page.html")
