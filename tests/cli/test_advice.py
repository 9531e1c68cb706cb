"""What messages say to type works, as it is typed."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import ROOT, Result, assert_alike, refused

Run = Callable[..., Result]
RECORD = (ROOT / "samples" / "scara2.csv").read_text("utf-8").splitlines()
GOOD = "\nscarid identify: good: "


@pytest.fixture
def rounded(tmp_path: Path) -> Path:
    """A log of 400 Hz, whose times are rounded to milliseconds: four times as fast as it was."""
    rows = (line.split(",", 1)[1] for line in RECORD[1:])
    lines = [f"{0.0025 * k:.3f},{row}" for k, row in enumerate(rows)]
    (path := tmp_path / "rounded.csv").write_text("\n".join([RECORD[0], *lines]) + "\n")
    return path


@pytest.fixture
def holed(tmp_path: Path) -> Path:
    """A log with three values that are missing."""
    lines = list(RECORD)
    for k in (100, 200, 201):
        t, _, *others = lines[k].split(",")
        lines[k] = ",".join([t, "nan", *others])
    (path := tmp_path / "holed.csv").write_text("\n".join(lines) + "\n")
    return path


def typed(message: str) -> str:
    """The command that a message quotes."""
    return re.findall(r"`(scarid [^`]*)`", message)[-1]


def test_every_command_advises_the_same_rate(rounded: Path, scarid: Run) -> None:
    for command in ("identify", "differentiate", "filter", "tune"):
        assert "resample --rate 400 " in typed(scarid(command, rounded).err)
    assert "`scarid resample --rate 400`" in scarid("check", rounded).out
    assert "nominal 400 Hz, mean 400 Hz" in scarid("info", rounded).out


def test_a_clock_that_ends_at_another_rate_is_told_its_mean(
    rounded: Path, scarid: Run, tmp_path: Path
) -> None:
    """The first interval is 0.9 % longer than the others, which is no jitter."""
    lines = RECORD[:1]
    for k, line in enumerate(RECORD[1:]):
        lines.append(f"{0.01 * k + (0.00009 if k else 0.0):.6f},{line.partition(',')[2]}")
    rounded.write_text("\n".join(lines) + "\n")
    failed = scarid("differentiate", rounded, "-o", tmp_path / "m.csv")
    refused(failed, 65, "mean interval", "resample --rate 100 ")


@pytest.mark.parametrize("options", ["", "--from-time 0.2 --robot scara2"])
@pytest.mark.parametrize("name", ["rounded", "holed"])
def test_the_pipe_that_a_refusal_states_works(
    name: str, options: str, shell: Run, request: pytest.FixtureRequest
) -> None:
    path: Path = request.getfixturevalue(name)
    failed = shell(f"scarid identify {options} {path.name}")
    refused(failed, 65, "resample --rate")
    found = shell(typed(failed.err))
    assert found.status == 0
    assert (GOOD if name == "holed" else "identify: doubtful: scale: ") in found.err
    piped = shell(f"cat {path.name} | scarid identify {options}")
    refused(piped, 65)
    assert_alike(shell(f"cat {path.name} | {typed(piped.err)}").out, found.out)


def test_rows_that_were_dropped_are_dropped_by_the_pipe_too(holed: Path, shell: Run) -> None:
    failed = shell(f"scarid identify --missing drop {holed.name}")
    refused(failed, 65, "expected 0.01 s")
    assert GOOD in shell(typed(failed.err)).err


def test_one_of_several_logs_is_mended(holed: Path, users_shell: Run) -> None:
    failed = users_shell(f"scarid identify $SAMPLES/scara2.csv {holed.name}")
    refused(failed, 65, "expected a finite number")
    assert GOOD in users_shell(typed(failed.err)).err


def test_resample_says_which_option_leaves_rows_out(holed: Path, scarid: Run) -> None:
    refused(scarid("resample", "--rate", 100, holed), 65, "with --missing drop")
    assert scarid("resample", "--rate", 100, "--missing", "drop", holed).status == 0


def test_check_says_how_missing_values_are_mended(holed: Path, shell: Run) -> None:
    command = typed(shell(f"scarid check {holed.name}").out)
    assert shell(f"{command} {holed.name} | scarid identify").status == 0


def test_a_line_that_ends_in_a_comma_has_no_further_column(tmp_path: Path, scarid: Run) -> None:
    (path := tmp_path / "trailing.csv").write_text("".join(f"{line},\n" for line in RECORD))
    plain = scarid("identify", ROOT / "samples" / "scara2.csv")
    assert scarid("identify", path).out == plain.out
    assert scarid("convert", path).out.splitlines() == RECORD


@pytest.mark.parametrize(
    ("row", "found"),
    [("1.5,2.5,7", "column 3: found '7', expected nothing"), ("1.5,2.5", "found 2 values")],
)
def test_rows_must_end_as_the_header_does(
    row: str, found: str, tmp_path: Path, scarid: Run
) -> None:
    (path := tmp_path / "log.csv").write_text(f"t,q1,\n0.5,1.5,\n{row}\n")
    refused(scarid("convert", path, "-o", tmp_path / "out.csv"), 65, "log.csv, row 2", found)


def test_the_index_that_pandas_writes_is_a_column(tmp_path: Path, scarid: Run) -> None:
    lines = [f"{k - 1 if k else ''},{line}" for k, line in enumerate(RECORD)]
    (path := tmp_path / "pandas.csv").write_text("\n".join(lines) + "\n")
    plain = scarid("identify", ROOT / "samples" / "scara2.csv")
    assert scarid("identify", path).out == plain.out
    assert scarid("convert", path).out.splitlines() == ["index" + lines[0], *lines[1:]]


def test_a_header_with_a_nameless_column_can_be_replaced(tmp_path: Path, shell: Run) -> None:
    rows = [line.partition(",") for line in RECORD]
    lines = [f"{t},{k or ''},{rest}" for k, (t, _, rest) in enumerate(rows)]
    (tmp_path / "numbered.csv").write_text("\n".join(lines) + "\n")
    failed = shell("scarid identify numbered.csv")
    refused(failed, 65, "column 2: found no name")
    replaced = re.findall(r"`(.*)`", failed.err)[0].replace(
        "NAMES", RECORD[0].replace("t", "t,number", 1)
    )
    assert shell(f"{replaced} | scarid identify").status == 0


@pytest.mark.parametrize(
    ("words", "advised"),
    [
        ("identify LOG", False),
        ("differentiate LOG then identify", False),
        ("differentiate LOG -o MOTION.csv", False),
        ("differentiate --method p2smd --no-match LOG then identify", True),
    ],
)
def test_a_motion_that_is_matched_is_not_to_be_matched(
    words: str, scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, advised: bool
) -> None:
    """Nor is a measurement, which `identify` matches; a CSV says so by its settling rows only."""
    module = "scarid_cli.algorithms.inference.verdict"
    monkeypatch.setattr(f"{module}._moved", lambda *_: "Fv1 would change")
    log, motion = ROOT / "samples" / "scara2.csv", tmp_path / "motion"
    words = words.replace("LOG", str(log)).replace("MOTION", str(motion))
    found = scarid(*words.split())
    if "-o" in words:
        found = scarid("identify", f"{motion}.csv")
    assert "the estimates depend on the soft sensor" in found.err
    assert ("use scarid differentiate --match" in found.err) == advised


def test_a_collision_is_named_with_what_leaves_it_out(tmp_path: Path, shell: Run) -> None:
    made = shell(
        "scarid trajgen -q --seed 2 --duration 12 | scarid simulate -q --seed 2 -o clean.csv"
    )
    assert made.status == 0
    header, *rows = (tmp_path / "clean.csv").read_text().splitlines()
    lines = []
    for t, q1, q2, tau1, *others in (row.split(",") for row in rows):
        hit = 300.0 if 3.0 <= float(t) < 3.05 else 0.0
        lines.append(",".join([t, q1, q2, f"{float(tau1) + hit}", *others]))
    (tmp_path / "hit.csv").write_text("\n".join([header, *lines]) + "\n")
    found = shell("scarid identify hit.csv").err
    named = re.search(
        r"doubtful: the torques at ([\d.]+) to ([\d.]+) s cannot .* with (.*?);", found
    )
    assert named
    assert float(named[1]) == pytest.approx(2.95, abs=0.06)
    assert float(named[2]) == pytest.approx(3.1, abs=0.11)
    assert "--essential" not in found
    assert GOOD in shell(f"scarid identify {named[3]} hit.csv").err
