"""Settings in a file: made by tune, taken by differentiate."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, refused

Run = Callable[..., Result]


@pytest.fixture
def log(samples: Path) -> Path:
    return samples / "scara2.csv"


@pytest.fixture
def short(log: Path, tmp_path: Path) -> Path:
    """The start of the log, where it does not matter how good the settings are."""
    path = tmp_path / "short.csv"
    path.write_text("".join(log.read_text("utf-8").splitlines(keepends=True)[:121]))
    return path


def test_saved_settings_are_those_that_were_chosen(log: Path, tmp_path: Path, scarid: Run) -> None:
    saved = tmp_path / "p2smd.toml"
    trials = scarid("tune", "-q", "--method", "p2smd", log, "--save", saved)
    assert trials.status == 0
    (chosen,) = (line.split(",") for line in trials.out.splitlines() if line.endswith(",1"))
    settings = dict(pair.split("=") for pair in chosen[1].split())
    by_hand = []
    for name in ("gamma0", "gamma1"):
        by_hand += ["--set", f"{name}={settings[name]}"]
    ours = scarid("differentiate", "--settings", saved, log).out
    theirs = scarid("differentiate", "--method", "p2smd", *by_hand, log).out
    # The table rounds to six digits.
    for row, other in zip(ours.splitlines()[1:], theirs.splitlines()[1:], strict=True):
        numbers = [float(x) for x in row.split(",")]
        assert numbers == pytest.approx([float(x) for x in other.split(",")], rel=1e-3, abs=1e-3)


def test_the_same_seed_gives_the_same_bytes(short: Path, tmp_path: Path, scarid: Run) -> None:
    files = [tmp_path / name for name in ("a.toml", "b.toml")]
    runs = [
        scarid("tune", "-q", "--method", "high-gain", "--seed", 3, short, "--save", file).out
        for file in files
    ]
    assert runs[0] == runs[1]
    assert files[0].read_bytes() == files[1].read_bytes()


def test_all_saves_every_causal_method(short: Path, tmp_path: Path, scarid: Run) -> None:
    saved = tmp_path / "all.toml"
    words = ["tune", "-q", "--method", "kalman", "--method", "all", short, "--save", saved]
    assert scarid(*words).status == 0
    text = saved.read_text("utf-8")
    assert 'method = "kalman"' in text
    for name in ("p2smd", "levant", "savgol-end", "backward"):
        assert f"[{name}]" in text
    for name in ("levant", "savgol-end"):
        assert scarid("differentiate", "--settings", saved, "--method", name, short).status == 0


def test_with_a_robot_all_methods_get_one_bandwidth(log: Path, tmp_path: Path, scarid: Run) -> None:
    saved = tmp_path / "x.toml"
    methods = ("rts", "kalman", "high-gain", "levant")
    words = [word for name in methods for word in ("--method", name)]
    result = scarid("tune", "--robot", "scara2", *words, log, "--save", saved)
    assert result.status == 0
    rows = [line.split(",") for line in result.out.splitlines()[1:]]
    curve = [row for row in rows if row[2] == "scatter"]
    assert all(row[0] == "zero-phase" and int(row[4]) > 0 for row in curve)
    (best,) = (row for row in curve if row[5] == "1")
    assert float(best[3]) <= 1.5 * min(float(row[3]) for row in curve)
    chosen = {row[0]: row[2] for row in rows if row[5] == "1" and row[2] != "scatter"}
    assert chosen == {**dict.fromkeys(methods, "bandwidth"), "levant": "smoother"}
    assert "cut-off" in result.err
    text = saved.read_text("utf-8")
    assert text.splitlines()[1] == 'method = "rts"'
    motion = tmp_path / "motion.parquet"
    scarid("differentiate", "--settings", saved, log, "-o", motion)
    cutoff = float(best[1].split()[0].partition("=")[2])
    bandwidth = scarid("info", motion).out.split("bandwidth", 1)[1].split()[0]
    assert float(bandwidth) == pytest.approx(0.896 * cutoff, rel=0.02)


def test_the_first_seconds_are_enough_for_settings(log: Path, tmp_path: Path, scarid: Run) -> None:
    """The same as from a log that ends there."""
    short = tmp_path / "short.csv"
    lines = log.read_text("utf-8").splitlines(keepends=True)
    short.write_text("".join(lines[: 1 + 400]))
    whole = scarid("tune", "--robot", "scara2", "--to-time", "4", log)
    assert whole.status == 0
    assert whole.out == scarid("tune", "--robot", "scara2", short).out


def test_joints_that_disagree_are_reported(tmp_path: Path, scarid: Run) -> None:
    log = tmp_path / "log.csv"
    rows = [
        f"{0.01 * k:.2f},{math.sin(0.01 * k) + 1e-4 * math.sin(1e4 * k * k)!r},"
        f"{math.sin(0.2 * k) + 1e-4 * math.cos(1e4 * k * k)!r}\n"
        for k in range(1000)
    ]
    log.write_text(f"t,q1,q2\n{''.join(rows)}")
    result = scarid("tune", log)
    assert result.status == 0
    assert "warning: by themselves, the joints would have bandwidths of" in result.err
    assert "--robot" in result.err


def test_settings_that_differ_between_joints_are_refused_with_matching(
    log: Path, tmp_path: Path, scarid: Run
) -> None:
    words = ["differentiate", "--set", "noise=5e-5,2e-5", log]
    refused(scarid(*words), 2, "different settings (noise)", "--per-joint")
    assert scarid(*words, "--per-joint").status == 0
    assert scarid(*words, "--no-match").status == 0
    saved = tmp_path / "x.toml"
    saved.write_text('method = "high-gain"\n[high-gain]\nbandwidth = [20.0, 30.0]\n')
    refused(scarid("differentiate", "--settings", saved, log), 2, "(bandwidth)")


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
    refused(result, 65, "short.csv: ", "too few")


def test_a_log_that_does_not_move_leaves_no_files(tmp_path: Path, scarid: Run) -> None:
    log, saved, out = (tmp_path / name for name in ("still.csv", "x.toml", "trials.csv"))
    rows = "".join(f"{0.01 * k:.2f},0,0,0,0\n" for k in range(200))
    log.write_text(f"t,q1,q2,tau1,tau2\n{rows}")
    words = ["--method", "high-gain", "--robot", "scara2", "--save", saved, "-o", out]
    result = scarid("tune", *words, log)
    assert result.status == 65
    assert "joints 1, 2 do not move; give a log in which every joint moves" in result.err
    assert result.err.count("\n") == 1
    assert not saved.exists()
    assert not out.exists()


@pytest.mark.parametrize("words", [("--robot", "scara2"), ("--method", "savgol")])
def test_a_time_in_milliseconds_is_named(
    words: tuple[str, ...], short: Path, tmp_path: Path, scarid: Run
) -> None:
    names, *rows = short.read_text("utf-8").splitlines()
    late = (row.split(",", 1) for row in rows)
    times = [f"{1000.0 * float(t):.0f},{rest}" for t, rest in late]
    log = tmp_path / "ms.csv"
    log.write_text("\n".join([names, *times, ""]))
    assert "the time seems to be in ms" in scarid("tune", *words, log).err
