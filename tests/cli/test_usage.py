"""A wrong command line: exit 2 and one line that says what to type."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, refused

Run = Callable[..., Result]

USAGE = {
    "no such file": (["filter", "nowhere.csv"], "nowhere.csv: no such file"),
    "no such option": (["filter", "--frob"], "No such option '--frob'"),
    "no such command": (["frobnicate"], "no such command 'frobnicate'"),
    "one output twice": (["identify", "--trace", "-"], "standard output: two outputs cannot share"),
    "no such robot": (
        ["trajgen", "--robot", "r2d2"],
        "unknown robot 'r2d2'; choose emps, planar2-gravity, scara2",
    ),
    "macros of a URDF": (
        ["trajgen", "--robot", "my arm.urdf.xacro"],
        "make it a URDF first: `xacro 'my arm.urdf.xacro' > 'my arm.urdf'`",
    ),
    "no such method": (["differentiate", "--method", "magic"], "'magic' is not one of"),
    "no such column": (["filter", "-c", "q7", "LOG"], "no column 'q7'; the table has t, q1"),
    "no such setting": (["differentiate", "--set", "gamma2=1", "LOG"], "has no setting 'gamma2'"),
    "no number": (["differentiate", "--set", "noise=x", "LOG"], "'x' is not a number"),
    "negative gain": (["differentiate", "--set", "noise=-1", "LOG"], "noise must be positive"),
    "too many values": (["differentiate", "--set", "noise=1,2,3", "LOG"], "3 values for 2 joints"),
    "even window": (
        ["differentiate", "--method", "savgol", "--set", "window=80", "LOG"],
        "window must be odd, not 80",
    ),
    "cutoff above half the rate": (
        ["differentiate", "--method", "zero-phase", "--set", "cutoff=60", "LOG"],
        "cutoff 60 Hz is not below half the rate, 50 Hz",
    ),
    "no such preset": (
        ["differentiate", "--method", "p2smd", "--preset", "best", "LOG"],
        "it has table1",
    ),
    "time filtered": (["filter", "-c", "*", "LOG"], "the column t is not a signal and cannot be"),
    "marks filtered": (["filter", "-c", "segment", "GAPPED"], "the column segment is not a signal"),
    "two cut-offs": (["filter", "--cutoff", "1", "--natural-frequency", "1"], "not both"),
    "cut-off above Nyquist": (
        ["filter", "--cutoff", "50", "LOG"],
        "not below half the rate, 50 Hz",
    ),
    "p0 of ls": (["identify", "--estimator", "ls", "--p0", "1"], "ls has no setting 'p0'"),
    "trace of ls": (["identify", "--estimator", "ls", "--trace", "t.csv"], "no estimates after"),
    "setting without a value": (["identify", "--set", "p0"], "write NAME=VALUE"),
    "setting that is no number": (["identify", "--set", "p0=x"], "'x' is not a number"),
    "two values of a setting": (["identify", "--set", "p0=1,2"], "p0: give one value, not 2"),
    "skip of three": (["identify", "--skip", "1,2,3"], "at the start and at the end"),
    "decimation by a half": (["identify", "--decimate", "0.5"], "whole numbers of at least 2"),
    "negative slow": (["identify", "--drop-slow", "-1"], "cannot be negative"),
    "sign over no velocity": (["identify", "--smooth-sign", "0"], "give a finite number above 0"),
    "state of aligned rows": (["identify", "--align", "--save", "s.npz"], "work row by row"),
    "state of held rows": (
        ["identify", "--estimator", "irls", "--save", "s.npz"],
        "work row by row",
    ),
    "forgetting above 1": (["identify", "--forgetting", "1.1"], "forgetting must not exceed 1"),
    "unknown extension": (["convert", "LOG", "-o", "x.xlsx"], "x.xlsx: unknown extension"),
    "bounds of no size": (
        ["trajgen", "--q-max", "0"],
        "--q-max: the bounds must be positive and finite",
    ),
    "negative seed of a motion": (["trajgen", "--seed", "-1"], "-1 is not in the range x>=0"),
    "negative seed of noise": (["simulate", "--seed", "-1", "REF"], "-1 is not in the range"),
    "negative seed of a search": (["tune", "--seed", "-1", "LOG"], "-1 is not in the range"),
    "duration too short": (["trajgen", "--duration", "1"], "too short for 2 segments"),
    "rates do not fit": (
        ["simulate", "--control-rate", "300", "REF"],
        "whole multiple of the traj",
    ),
}


@pytest.mark.parametrize("name", USAGE)
def test_a_wrong_command_line_is_reported_in_one_line(
    name: str, scarid: Run, samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words, message = USAGE[name]
    if "REF" in words:
        assert scarid("trajgen", "--duration", 2, "-o", "ref.csv").status == 0
    if "GAPPED" in words:
        gapped = scarid("resample", "--rate", 100, samples / "scara2.csv", "-o", "gapped.csv")
        assert gapped.status == 0
    files = {"GAPPED": "gapped.csv", "LOG": str(samples / "scara2.csv"), "REF": "ref.csv"}
    refused(scarid(*(files.get(word, word) for word in words)), 2, message)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["differentiate", "--estimator", "wls"], "no such option: --estimator; identify has it"),
        (["identify", "--method", "p2smd"], "--method; tune and differentiate have it"),
        (["filter", "--robot", "arm.toml"], "no such option: --robot; trajgen, simulate and "),
        (["filter", "--rowz", "1:2"], "Did you mean '--rows'?"),
        (["identify", "-z"], "No such option '-z' "),
    ],
)
def test_an_option_of_another_command_is_named_as_such(
    scarid: Run, words: list[str], said: str
) -> None:
    found = scarid(*words)
    assert (found.status, found.out) == (2, "")
    assert said in found.err
    assert len(found.err.splitlines()) == 1
