"""Options of identify that need more than one table: going on, treatments, essential parameters."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from conftest import Result, refused

from scarid_cli.cli.actions.identify import summary_lines
from scarid_cli.io.table import METADATA_KEY, Metadata

Shell = Callable[..., Result]
HALVES = (
    "head -301 motion.csv > first.csv && (head -1 motion.csv; tail -n +302 motion.csv) > second.csv"
)


@pytest.fixture(autouse=True)
def motion(scarid: Callable[..., Result], samples: Path, tmp_path: Path) -> None:
    """The motion of the sample, in the directory of the shell."""
    assert (
        scarid("differentiate", samples / "scara2.csv", "-o", tmp_path / "motion.csv").status == 0
    )


@pytest.mark.parametrize("options", ["", "--forgetting 0.999,Fs1=0.99", "--estimator wls",
                                     "--estimator ekf --initial apriori"])  # fmt: skip
def test_two_logs_one_after_the_other_are_as_one(options: str, shell: Shell) -> None:
    result = shell(
        f"{HALVES} && scarid identify -q {options} motion.csv > whole.csv &&"
        f" scarid identify -q {options} --save state.npz first.csv > /dev/null &&"
        f" scarid identify -q {options} --from state.npz second.csv | cmp - whole.csv"
    )
    assert (result.status, result.out, result.err) == (0, "", "")


def test_a_saved_state_is_for_the_same_estimation(shell: Shell) -> None:
    result = shell(
        f"{HALVES} && scarid identify -q --save state.npz first.csv > /dev/null &&"
        " scarid identify --from state.npz --forgetting 0.9 second.csv"
    )
    assert result.status == 2
    assert "saved with settings" in result.err
    assert "continue it with the same" in result.err


@pytest.mark.parametrize(
    ("make", "status", "reported"),
    [
        ("true", 2, "no such file"),
        ("echo no > state.npz", 65, "not a saved estimation"),
        ("scarid identify -q --save state.npz motion.csv | head -1 > /dev/null;"
         "truncate -s 1000 state.npz", 65, "not a saved estimation"),
    ],
    ids=["missing", "not a state", "cut"],
)  # fmt: skip
def test_a_file_that_is_not_a_saved_estimation_is_refused(
    make: str, status: int, reported: str, shell: Shell
) -> None:
    result = shell(f"{make}; scarid identify --from state.npz motion.csv")
    assert result.status == status
    assert reported in result.err
    assert len(result.err.splitlines()) == 1


def test_a_failed_estimation_saves_no_state(shell: Shell) -> None:
    result = shell(
        "awk 'NR == 50 {sub(/^[^,]*/, \"x\")} 1' motion.csv > bad.csv;"
        " scarid identify --save state.npz bad.csv -o p.csv; ls"
    )
    assert "state.npz" not in result.out
    assert "p.csv" not in result.out


def rows_of(result: Result) -> dict[str, dict[str, str]]:
    assert result.status == 0, result.err
    return {row["parameter"]: row for row in csv.DictReader(io.StringIO(result.out))}


def test_rows_skipped_at_both_ends_are_as_if_they_were_not_there(shell: Shell) -> None:
    result = shell(
        "(head -1 motion.csv; sed -n '12,481p' motion.csv) > inner.csv && for e in"
        " 'ls' 'wls --align'; do scarid identify -q --estimator $e inner.csv > a.csv && scarid"
        " identify -q --skip 10,21 --estimator $e motion.csv | cmp - a.csv; done"
    )
    assert (result.status, result.out, result.err) == (0, "", "")


def test_essential_parameters_are_kept_and_the_others_are_zero(shell: Shell) -> None:
    result = shell(
        "scarid trajgen -q | scarid simulate | scarid differentiate |"
        " scarid identify --estimator wls --drop-slow 0.1 --essential"
    )
    rows = rows_of(result)
    assert "dropped L1MY2" in result.err
    assert float(rows["L1MY2"]["estimate"]) == 0.0
    assert rows["L1MY2"]["standard_error"] == rows["L1MY2"]["low"] == ""
    assert float(rows["ZZ2"]["estimate"]) == pytest.approx(0.064, rel=0.01)


def test_instruments_of_the_simulated_robot_agree_with_least_squares_on_a_clean_log(
    shell: Shell,
) -> None:
    pipe = (
        "scarid trajgen -q --seed 2 | scarid simulate --seed 2 | scarid differentiate |"
        " scarid identify --estimator NAME --drop-slow 0.1"
    )
    least, instruments = (rows_of(shell(pipe.replace("NAME", name))) for name in ("wls", "iv"))
    for name, row in instruments.items():
        apart = abs(float(row["estimate"]) - float(least[name]["estimate"]))
        assert apart < 3.0 * float(row["robust_error"]), name
    assert "Durbin-Wu-Hausman p" in shell(pipe.replace("NAME", "iv")).err


def test_didim_needs_no_measured_positions(shell: Shell) -> None:
    """Only the time, the torques and the reference are left of the log."""
    pipe = (
        "scarid trajgen -q --seed 2 | scarid simulate --seed 2 | FILTER |"
        " scarid identify --estimator didim"
    )
    whole = rows_of(shell(pipe.replace("FILTER", "cat")))
    assert rows_of(shell(pipe.replace("FILTER", "cut -d, -f1,4-"))) == whole
    assert whole["ZZ1R"]["estimate"].startswith("3.4")


def test_stribeck_friction_goes_on_to_validate(shell: Shell) -> None:
    result = shell(
        "scarid identify -q --estimator separable motion.csv -o p.csv &&"
        " cut -d, -f1,2 p.csv | tail -4 && scarid validate --parameters p.csv motion.csv"
    )
    assert result.status == 0, result.err
    assert result.out.splitlines()[:4] == ["Fst1,N m", "Fst2,N m", "vs1,rad/s", "vs2,rad/s"]


def test_friction_is_smoothed_alike_in_identify_and_validate(shell: Shell) -> None:
    """Least squares of the smooth model beat those of the sharp one in the smooth model."""
    fit = "scarid identify -q --estimator ls motion.csv"
    judge = "scarid validate --smooth-sign 0.1 motion.csv --parameters"
    squares = "awk -F, 'NR > 1 { sum += $3 * $3 } END { print sum }'"
    result = shell(
        f"{fit} --smooth-sign 0.1 -o smooth.csv && {fit} -o sharp.csv &&"
        f" for p in smooth sharp; do {judge} $p.csv | {squares}; done"
    )
    smooth, sharp = map(float, result.out.split())
    assert smooth < sharp


def test_the_metadata_hold_the_verdict_and_its_numbers(shell: Shell) -> None:
    result = shell(
        "scarid trajgen -q --format arrow | scarid simulate --format arrow |"
        " scarid differentiate --format arrow | scarid identify -q --align --drop-slow 0.1"
        " --estimator wls -o p.parquet && scarid info p.parquet"
    )
    lines = result.out.splitlines()
    keys = {line.split()[0] for line in lines}
    assert {"verdict", "delay", "effects", "excitation", "scaled_condition_number"} <= keys
    assert "7 of 8 parameters known" in lines[lines.index("reasons") + 1]
    assert "autocorrelation" in lines[lines.index("joints") + 1]


@pytest.mark.parametrize(
    ("options", "reported"),
    [
        ("identify --skip 10000", "no rows to fit"),
        ("identify --skip 10000 --estimator ml", "no rows to fit"),
        ("identify --skip 10000 --decimate 10", "no rows to fit"),
        ("identify --drop-slow 1000", "no rows to fit"),
        ("identify --decimate 100 --skip 0,300", "4 rows to fit"),
        ("identify --estimator wls --align --all-rows --skip 0,473", "8 rows to fit"),
        ("validate --parameters $SAMPLES/scara2.parameters.csv --skip 10000", "no rows to fit"),
    ],
)
def test_too_few_rows_are_reported_in_one_line(options: str, reported: str, shell: Shell) -> None:
    result = shell(f"scarid {options} motion.csv -o out.csv; s=$?; ls; exit $s")
    assert result.status == 65
    assert reported in result.err
    assert "leave out fewer rows" in result.err
    assert len(result.err.splitlines()) == 1
    assert "out.csv" not in result.out


@pytest.mark.parametrize("estimator", ["ls", "wls", "tls", "irls"])
def test_initial_parameters_are_refused_by_an_estimator_without_them(
    estimator: str, shell: Shell
) -> None:
    pipe = f"scarid identify --estimator {estimator} --initial apriori motion.csv"
    result = shell(pipe)
    refused(result, 2, f"--initial: {estimator} has no initial parameters")


@pytest.mark.parametrize("options", ["--estimator tls", "--forgetting 0.999,Fv1=0.99"])
def test_the_delay_goes_with_the_parameters_to_validate(options: str, shell: Shell) -> None:
    """In Parquet and in CSV."""
    align = f"scarid identify --align {options}"
    made = shell(
        f"scarid differentiate $SAMPLES/scara2.csv -o m.parquet && {align} m.parquet -o p.parquet"
        f" && {align} m.parquet -o p.csv"
    )
    assert made.status == 0, made.err
    one, other = (
        shell(f"scarid validate --parameters p.{kind} m.parquet") for kind in ("parquet", "csv")
    )
    assert "applied the delay that identify fitted" in one.err
    assert "applied the delay that identify fitted" in other.err
    assert one.out == other.out


def test_the_friction_of_separable_is_no_initial_value_of_others(shell: Shell) -> None:
    result = shell(
        "scarid identify -q --estimator separable motion.csv -o p.csv;"
        " scarid identify --initial p.csv motion.csv"
    )
    refused(result, 2, "p.csv has friction that fades with speed (separable)")


def test_a_delay_that_the_log_does_not_show_is_said_to_be_none(
    shell: Shell, tmp_path: Path
) -> None:
    """Without the rows of joint 1, none of its parameters is known, and so no error is."""
    result = shell("scarid identify --align --drop-slow 100,0 motion.csv -o none.parquet")
    assert result.status == 0, result.err
    assert "taken as in step with the motion, because the log does not show a delay" in result.err
    assert "nan" not in result.err
    stored = pq.read_schema(tmp_path / "none.parquet").metadata[METADATA_KEY]
    extra = Metadata.from_json(stored).extra
    assert extra["delay"] is extra["delay_error"] is None


@pytest.mark.parametrize(("thin", "words"), [(2, "every 2nd"), (4, "every 4th")])
def test_a_fit_of_some_samples_says_of_which(thin: int, words: str) -> None:
    extra = {"samples": 50_000, "thinned": thin, "reasons": [], "verdict": "good"}
    line, _ = summary_lines("arm", "gls", extra)
    assert line == f"arm, gls, 50000 samples ({words} fitted)"
