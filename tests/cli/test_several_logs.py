"""Commands that take several logs as one, and those that read a part of a log."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, refused

Run = Callable[..., Result]
Shell = Callable[..., Result]


@pytest.fixture(autouse=True)
def halves(scarid: Run, samples: Path, tmp_path: Path) -> None:
    """The two halves of the sample, and their motions, in the directory of the shell."""
    names, *rows = (samples / "scara2.csv").read_text("utf-8").splitlines(keepends=True)
    for name, part in (("a", rows[:250]), ("b", rows[250:])):
        (tmp_path / f"{name}.csv").write_text("".join([names, *part]))
        motion = tmp_path / f"{name}.parquet"
        settings = ("--method", "rts", "--set", "noise=4e-5", "--set", "intensity=700")
        assert (
            scarid("differentiate", *settings, tmp_path / f"{name}.csv", "-o", motion).status == 0
        )


def column(text: str, name: str) -> list[float]:
    return [float(row[name]) for row in csv.DictReader(io.StringIO(text))]


@pytest.mark.parametrize("options", ["", "--forgetting 0.999", "--trace t.csv"])
def test_several_motions_give_the_estimates_of_one_after_the_other(
    options: str, shell: Shell
) -> None:
    """Bit for bit those of --save and --from; the errors allow for the gap, which these do not."""
    together = shell(f"scarid identify -q {options} a.parquet b.parquet")
    apart = shell(
        f"scarid identify -q {options} --save s.npz a.parquet > /dev/null;"
        f" scarid identify -q {options} --from s.npz b.parquet"
    )
    assert (together.status, together.err) == (0, "")
    assert column(together.out, "estimate") == column(apart.out, "estimate")
    assert column(together.out, "robust_error") == pytest.approx(
        column(apart.out, "robust_error"), rel=0.5
    )


def test_the_printed_command_for_several_measurements_gives_the_same_bytes(
    users_shell: Shell,
) -> None:
    once = users_shell("scarid identify --robot scara2 --to-time 4 a.csv b.csv")
    assert once.status == 0, once.err
    found = re.search(r"the same as: (.*)$", once.err, re.MULTILINE)
    assert found
    assert found[1].count("<(scarid differentiate") == 2
    again = users_shell(found[1])
    assert again.out == once.out
    assert once.err.count("cut-off") == once.err.count("torques lag by") == 1


def test_several_measurements_are_identified_nearly_as_the_whole_log(shell: Shell) -> None:
    two = column(shell("scarid identify -q a.csv b.csv").out, "estimate")
    one = column(shell("scarid identify -q $SAMPLES/scara2.csv").out, "estimate")
    for i in (0, 3, 4, 7):
        assert two[i] == pytest.approx(one[i], rel=0.01)


def test_metadata_name_all_inputs(shell: Shell) -> None:
    result = shell(
        "scarid identify -q a.parquet b.parquet -o p.parquet && scarid info --json p.parquet"
    )
    history = json.loads(result.out)["history"]
    assert [*history[-1]["inputs"]] == ["a.parquet", "b.parquet"]
    assert history[-1]["command"] == "scarid identify a.parquet b.parquet"
    assert sum("differentiate" in entry["command"] for entry in history) == 2


def test_metrics_of_several_motions_are_those_of_their_rows(shell: Shell) -> None:
    shell("scarid identify -q a.parquet -o p.parquet")
    together = shell("scarid validate -q --parameters p.parquet a.parquet b.parquet")
    parts = [shell(f"scarid validate -q --parameters p.parquet {x}.parquet") for x in "ab"]
    counts = [column(part.out, "samples") for part in parts]
    # Slowness is judged by the velocities so far, so that a few rows more or less count.
    assert column(together.out, "samples") == pytest.approx(
        [*map(sum, zip(*counts, strict=True))], 8
    )


@pytest.mark.parametrize(
    ("make", "command", "status", "reported"),
    [
        ("true", "identify a.csv a.csv", 2, ["a.csv", "given twice"]),
        ("true", "identify a.parquet b.csv", 65, ["b.csv has not", "scarid differentiate"]),
        ("true", "identify --skip 9 a.csv b.csv", 2, ["--skip", "--rows"]),
        ("scarid resample -q --rate 50 b.csv > c.csv", "identify a.csv c.csv", 65,
         ["c.csv: found a period of 0.02 s, expected 0.01 s, as in a.csv", "scarid resample"]),
        ("cut -d, -f1,2,4 b.csv > c.csv", "identify a.csv c.csv", 65, ["c.csv", "column q2"]),
        ("scarid convert --robot planar2-gravity b.csv -o c.parquet;"
         " scarid convert --robot scara2 a.csv -o d.parquet",
         "identify d.parquet c.parquet", 65, ["c.parquet", "planar2-gravity", "--robot"]),
        ("true", "identify --from-time 50 a.csv", 65, ["a.csv", "from 0 to 2.49 s", "--from-time"]),
        ("true", "tune --from-time 2 --to-time 1 a.csv", 2, ["--to-time 1 is not after"]),
        ("true", "filter --rows 5 a.csv", 2, ["--rows", "100:5000"]),
        ("sed 's/^1,[^,]*/1,nan/' a.csv > n.csv", "tune n.csv", 65,
         ["n.csv, row 101, column q1: found nan", "--missing"]),
        ("sed 's/^1,[^,]*/1,nan/' a.csv > n.csv", "tune --missing drop n.csv", 65,
         ["n.csv, row 102, column t: found an interval of 0.02 s", "scarid resample"]),
    ],
)  # fmt: skip
def test_logs_that_do_not_fit_are_one_line(
    make: str, command: str, status: int, reported: list[str], shell: Shell
) -> None:
    refused(shell(f"({make}) 2>/dev/null; scarid {command}"), status, *reported)


def test_rows_without_a_value_split_a_log_and_are_told(shell: Shell) -> None:
    result = shell(
        "sed 's/^1,[^,]*/1,nan/' a.csv > n.csv; scarid differentiate --missing split n.csv"
    )
    assert "n.csv: left out 1 row with missing values" in result.err
    assert set(column(result.out, "segment")) == {0.0, 1.0}


@pytest.mark.parametrize(
    "words",
    ["resample --rate 100", "filter", "differentiate", "identify", "check", "info", "convert"],
)
def test_a_window_is_the_log_of_its_rows(words: str, scarid: Run, tmp_path: Path) -> None:
    """By time and by number alike, for every command that reads a log."""
    log, inner, command = tmp_path / "a.csv", tmp_path / "inner.csv", words.split()
    lines = log.read_text("utf-8").splitlines(keepends=True)
    inner.write_text("".join([lines[0], *lines[51:201]]))
    expected = scarid(*command, "-q", inner)
    for window in ("--rows 51:200", "--from-time 0.5 --to-time 2"):
        found = scarid(*command, "-q", *window.split(), log)
        assert found.status == expected.status
        assert found.out.replace("a.csv", "inner.csv") == expected.out != ""
