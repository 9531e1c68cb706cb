"""Settings in a file: made by tune, taken by differentiate."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, refused

Run = Callable[..., Result]


@pytest.fixture
def log(samples: Path) -> Path:
    return samples / "scara2.csv"


def test_saved_settings_are_those_that_were_chosen(log: Path, tmp_path: Path, scarid: Run) -> None:
    saved = tmp_path / "p2smd.toml"
    trials = scarid("tune", "-q", "--method", "p2smd", log, "--save", saved)
    assert trials.status == 0
    chosen = [line.split(",") for line in trials.out.splitlines() if line.endswith(",1")]
    settings = [dict(pair.split("=") for pair in row[2].split()) for row in chosen]
    by_hand = []
    for name in ("gamma0", "gamma1"):
        by_hand += ["--set", f"{name}={settings[0][name]},{settings[1][name]}"]
    ours = scarid("differentiate", "--settings", saved, log).out
    theirs = scarid("differentiate", "--method", "p2smd", *by_hand, log).out
    # The table rounds to six digits.
    for row, other in zip(ours.splitlines()[1:], theirs.splitlines()[1:], strict=True):
        numbers = [float(x) for x in row.split(",")]
        assert numbers == pytest.approx([float(x) for x in other.split(",")], rel=1e-3, abs=1e-3)


def test_the_same_seed_gives_the_same_bytes(log: Path, tmp_path: Path, scarid: Run) -> None:
    files = [tmp_path / name for name in ("a.toml", "b.toml")]
    runs = [
        scarid("tune", "-q", "--method", "high-gain", "--seed", 3, log, "--save", file).out
        for file in files
    ]
    assert runs[0] == runs[1]
    assert files[0].read_bytes() == files[1].read_bytes()


def test_all_saves_every_causal_method_and_the_best(log: Path, tmp_path: Path, scarid: Run) -> None:
    saved = tmp_path / "all.toml"
    assert scarid("tune", "-q", "--method", "all", log, "--save", saved).status == 0
    text = saved.read_text("utf-8")
    assert 'method = "kalman"' in text
    for name in ("p2smd", "levant", "savgol-end", "backward"):
        assert f"[{name}]" in text
        assert scarid("differentiate", "--settings", saved, "--method", name, log).status == 0


def test_with_a_robot_the_settings_are_one_for_all_joints(log: Path, scarid: Run) -> None:
    result = scarid("tune", "--method", "high-gain", "--robot", "scara2", log)
    rows = result.out.splitlines()[1:]
    assert all(",,bandwidth=" in row and ",torques," in row for row in rows)
    assert "torques" in result.err


def test_what_is_set_by_hand_comes_last(log: Path, tmp_path: Path, scarid: Run) -> None:
    saved = tmp_path / "x.toml"
    saved.write_text('method = "high-gain"\n[high-gain]\nbandwidth = [20.0, 30.0]\n')
    words = ["differentiate", "--settings", saved, "--set", "bandwidth=40", log]
    plain = ["differentiate", "--method", "high-gain", "--set", "bandwidth=40", log]
    assert scarid(*words).out == scarid(*plain).out


@pytest.mark.parametrize(
    ("text", "status", "message"),
    [
        ("nonsense", 65, "this is not a file of settings; make one with `scarid tune --save`"),
        ("[kalman]\nnoise = [1e-4]\n", 65, "this is not a file of settings"),
        ('method = "none"\n', 2, "no method 'none'"),
        ('method = "kalman"\n[kalman]\nnose = [1.0]\n', 2, "kalman has no setting 'nose'"),
        ('method = "kalman"\n[kalman]\nnoise = [1, 2, 3]\n', 2, "3 values for 2 joints"),
        ('method = "kalman"\n[kalman]\nnoise = [1]\n', 2, "1 value for 2 joints (kalman, noise)"),
        ('method = "kalman"\n', 2, "no settings for kalman, only for none"),
        (
            'method = "p2smd"\n[p2smd]\n[rts]\n',
            2,
            "no settings for kalman, only for p2smd, rts; choose one of these with --method",
        ),
    ],
)
def test_a_wrong_file_of_settings_is_reported_in_one_line(
    text: str, status: int, message: str, log: Path, tmp_path: Path, scarid: Run
) -> None:
    saved = tmp_path / "x.toml"
    saved.write_text(text)
    method = ["--method", "kalman"] if "[p2smd]" in text else []
    refused(scarid("differentiate", "--settings", saved, *method, log), status, message)


@pytest.mark.parametrize(
    "words", [(), ("--method", "p2smd"), ("--robot", "scara2")], ids=["kalman", "p2smd", "robot"]
)
def test_too_short_a_log_is_refused_with_the_rows_it_needs(
    words: tuple[str, ...], log: Path, tmp_path: Path, scarid: Run
) -> None:
    short = tmp_path / "short.csv"
    short.write_text("".join(log.read_text("utf-8").splitlines(keepends=True)[:4]))
    result = scarid("tune", *words, short)
    refused(result, 65, "short.csv: 3 rows are too few", "at least 10 rows")


def test_a_log_that_does_not_move_leaves_no_files(tmp_path: Path, scarid: Run) -> None:
    log, saved, out = (tmp_path / name for name in ("still.csv", "x.toml", "trials.csv"))
    rows = "".join(f"{0.01 * k:.2f},0,0,0,0\n" for k in range(200))
    log.write_text(f"t,q1,q2,tau1,tau2\n{rows}")
    words = ["--method", "high-gain", "--robot", "scara2", "--save", saved, "-o", out]
    result = scarid("tune", *words, log)
    assert result.status == 65
    assert "no settings could be judged" in result.err
    assert result.err.count("\n") == 1
    assert not saved.exists()
    assert not out.exists()
