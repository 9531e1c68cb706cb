"""Nothing is lost or mixed: outputs of one line, their parts, logs given twice, name clashes."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from conftest import Result, refused
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.errors import OutputFailure
from scarid_cli.io.target import PART, Target, _part_name

Run = Callable[..., Result]
SCARID = str(Path(sys.executable).with_name("scarid"))
WRITERS = {  # each writes FILE somewhere in a line of stages
    "tee": ("differentiate", "log.csv", "then", "tee", "FILE", "then"),
    "output": ("identify", "-o", "FILE"),
    "trace": ("identify", "--trace", "FILE"),
    "save": ("identify", "--save", "FILE"),
}


def spellings(folder: Path) -> list[str]:
    """Ways to name one file that is there."""
    (folder / "link.csv").symlink_to("y.csv")
    os.link(folder / "y.csv", folder / "hard.csv")
    return ["y.csv", "./y.csv", str(folder / "y.csv"), "link.csv", "hard.csv"]


@pytest.mark.parametrize("late", ["output", "trace", "save"])
def test_two_outputs_of_one_line_are_refused_before_anything_runs(
    late: str, tmp_path: Path, samples: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_bytes((samples / "scara2.csv").read_bytes())
    (tmp_path / "y.csv").write_text("precious")
    names = spellings(tmp_path)
    for one, other in product(names, names):
        first = [one if word == "FILE" else word for word in WRITERS["tee"]]
        second = [other if word == "FILE" else word for word in WRITERS[late]]
        refused(scarid(*first, *second, "--robot", "scara2"), 2, "two outputs cannot share it")
        assert (tmp_path / "y.csv").read_text() == "precious"


def test_an_output_of_a_line_is_no_input_of_it(
    tmp_path: Path, samples: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    log = (samples / "scara2.csv").read_bytes()
    (tmp_path / "log.csv").write_bytes(log)
    words = ("differentiate", "log.csv", "then", "tee", "./log.csv", "then", "identify")
    refused(scarid(*words), 2, "this is the input")
    assert (tmp_path / "log.csv").read_bytes() == log


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o444 | 0o200])
def test_a_part_has_the_mode_of_the_file_that_it_replaces(mode: int, tmp_path: Path) -> None:
    place = tmp_path / "private.csv"
    place.write_text("old")
    place.chmod(mode)
    target = Target(str(place))
    (part,) = tmp_path.glob(f".*{PART}")
    assert stat.S_IMODE(part.stat().st_mode) == mode
    target.write(b"new")
    target.commit(keep=False)
    target.settle()
    assert place.read_text() == "new"
    assert stat.S_IMODE(place.stat().st_mode) == mode


def test_a_planted_link_is_not_followed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Even by somebody who guesses the name."""
    victim = tmp_path / "victim"
    victim.write_text("untouched")
    monkeypatch.setattr("scarid_cli.io.target._part_name", lambda name: f".{name}.guessed")
    (tmp_path / ".o.csv.guessed").symlink_to(victim)
    with pytest.raises(OutputFailure, match=r"o\.csv: File exists"):
        Target(str(tmp_path / "o.csv"))
    assert victim.read_text() == "untouched"


@given(st.text("ab\N{LATIN SMALL LETTER E WITH ACUTE}\N{SNOWMAN}", min_size=1, max_size=255))
def test_names_of_parts_are_short_and_never_the_same(name: str) -> None:
    one, other = _part_name(name), _part_name(name)
    assert one != other
    assert len(os.fsencode(one)) <= 160


@pytest.mark.parametrize("length", [245, 249, 255])
def test_the_longest_names_are_written(length: int, tmp_path: Path, samples: Path) -> None:
    name = "n" * (length - 4) + ".csv"
    log = samples / "scara2.csv"
    subprocess.run([SCARID, "convert", "-q", log, "-o", name], cwd=tmp_path, check=True)
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("words", [("log.csv", "-"), ("/dev/stdin", "-"), ("-", "log.csv")])
def test_a_log_that_is_on_standard_input_as_well_counts_once(
    words: tuple[str, str], tmp_path: Path, samples: Path
) -> None:
    (tmp_path / "log.csv").write_bytes((samples / "scara2.csv").read_bytes())
    with (tmp_path / "log.csv").open() as log:
        done = subprocess.run(
            [SCARID, "identify", "--robot", "scara2", *words],
            stdin=log, cwd=tmp_path, capture_output=True, text=True, check=False,
        )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, "")
    assert "the log is given twice" in done.stderr


@pytest.mark.parametrize("extension", ["npz", "mat"])
@pytest.mark.parametrize("vector", ["q1", "q2"])
def test_a_matrix_and_a_vector_of_one_name_are_refused(
    extension: str, vector: str, tmp_path: Path, scarid: Run
) -> None:
    arrays = {"q": np.arange(200.0).reshape(100, 2), vector: np.zeros(100), "t": np.arange(100.0)}
    path = tmp_path / f"clash.{extension}"
    (np.savez(path, **arrays) if extension == "npz" else scipy.io.savemat(path, arrays))
    refused(scarid("convert", path), 65, f"column {vector}", "rename one of them")
