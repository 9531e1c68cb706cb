"""`scarid check --fix`: followed, it gives a log on which nothing of it is found again."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from conftest import Shell, shell_in

LOG = (
    "scarid trajgen -q --robot planar2-gravity --seed 3 --q-max 2,2 --ddq-max 20,30 --duration 20 |"
    " scarid simulate -q --robot planar2-gravity --seed 3"
)
FAULTS = {
    "degrees": "awk -F, -v OFS=, 'NR > 1 { $2 *= 57.29577951; $3 *= 57.29577951 } 1'",
    "degrees, with velocities": "awk -F, -v OFS=, '{ $2 *= 57.29577951; $3 *= 57.29577951 }"
    ' NR == 1 { print "t,q1,q2,tau1,tau2,dq1,dq2" }'
    " NR > 2 { print $0, ($2 - a) / ($1 - t), ($3 - b) / ($1 - t) } { t = $1; a = $2; b = $3 }'",
    "milliseconds": "awk -F, -v OFS=, 'NR > 1 { $1 *= 1000 } 1'",
    "torque reversed": "awk -F, -v OFS=, 'NR > 1 { $5 *= -1 } 1'",
    "exchanged": "awk -F, -v OFS=, '{ x = $4; if (NR > 1) { $4 = $5; $5 = x } } 1'",
    "rows missing": "awk 'NR < 100 || NR % 17'",
    "wraps": "awk -F, -v OFS=, 'NR > 1 { while ($2 > .5) $2 -= 1; while ($2 < -.5) $2 += 1 } 1'",
    "glitches": "awk -F, -v OFS=, 'NR == 500 || NR == 1200 { $2 += 40 } 1'",
    "a second run": "awk -F, -v OFS=, 'NR > 900 { $1 -= 4.5 } 1'",
    "two logs by cat": "awk -F, -v OFS=, 'NR == 1 { names = $0 } NR == 900 { print names }"
    " NR >= 900 { $1 -= 4.5 } 1'",
    "signals of motors": "awk -F, -v OFS=, 'NR > 1 { $2 *= 50; $3 *= 50; $4 /= 50; $5 /= 50 } 1'",
    "a pulley": "awk -F, -v OFS=, 'NR > 1 { $3 *= 2 } 1'",
    "a clock at half its rate": "awk -F, -v OFS=, 'NR > 1 { $1 *= 2 } 1'",
    "two sources in turn": "awk -F, -v OFS=, 'NR == 1 { print; next }"
    ' { print $1, $2, $3, "", ""; print $1 + .0013, "", "", $4, $5 }\'',
    "several": "awk -F, -v OFS=, 'NR > 1 { $1 *= 1000; $2 *= 57.29577951; $3 *= 57.29577951 }"
    " NR < 100 || NR % 17'",
}


@pytest.fixture(scope="module")
def right(tmp_path_factory: pytest.TempPathFactory, warm: Path) -> Path:
    """The log before it has a fault."""
    folder = tmp_path_factory.mktemp("right")
    made = shell_in(folder, warm)(f"{LOG} --format csv | cut -d, -f-5 > right.csv")
    assert made.status == 0, made.err
    return folder / "right.csv"


@pytest.mark.parametrize("fault", FAULTS)
def test_the_pipe_mends_the_log(fault: str, shell: Shell, right: Path) -> None:
    made = shell(f"{FAULTS[fault]} < {right} > log.csv")
    assert made.status == 0, made.err
    found = shell("scarid check --robot planar2-gravity --json log.csv")
    wrong = {x["name"] for x in json.loads(found.out)["checks"] if x["status"] != "ok"}
    assert wrong, fault
    pipe = shell("scarid check --robot planar2-gravity --fix log.csv")
    assert pipe.out.count("\n") == 1, pipe.err
    assert "not mended" not in pipe.err
    mended = shell(
        'eval "$(scarid check -q --robot planar2-gravity --fix log.csv)" > mended.csv;'
        " scarid check --robot planar2-gravity --json mended.csv"
    )
    again = {x["name"] for x in json.loads(mended.out)["checks"] if x["status"] != "ok"}
    assert not again & wrong, (pipe.out, again)
    good = shell("scarid identify --robot planar2-gravity mended.csv -o p.parquet")
    assert "scarid identify: good: " in good.err, good.err


@pytest.mark.parametrize("lost", ["1", "NR < 9 || NR % 17"])
def test_a_clock_that_counts_rows_has_one_unit(lost: str, shell: Shell, right: Path) -> None:
    """It seems to be in ms, and then at another rate: both are one factor."""
    counted = f"awk -F, -v OFS=, 'NR > 1 {{ $1 = NR - 2 }} {lost}'"
    made = shell(f"{counted} < {right} > log.csv")
    assert made.status == 0, made.err
    mended = shell(
        'pipe="$(scarid check -q --robot planar2-gravity --fix log.csv)"; echo "$pipe";'
        ' eval "$pipe" > mended.csv; scarid check --robot planar2-gravity mended.csv | tail -1'
    )
    assert mended.out.count("--unit") == 1, mended
    assert "0 failed" in mended.out, mended


def test_nothing_is_printed_of_a_log_that_is_right(shell: Shell) -> None:
    made = shell(
        f"{LOG} --format csv -o log.csv && scarid check --robot planar2-gravity --fix log.csv"
    )
    assert made.status == 0
    assert made.out == ""
    assert "nothing to mend" in made.err


def test_what_no_command_mends_is_said(shell: Shell) -> None:
    made = shell(f"{LOG} --format csv | cut -d, -f-5 > log.csv")
    assert made.status == 0
    found = shell(
        "awk -F, -v OFS=, 'NR > 1 { $5 = 0.2 } 1' log.csv > still.csv;"
        " scarid check --robot planar2-gravity --fix still.csv"
    )
    assert found.status == 65
    assert found.out == ""
    assert "not mended: constant torque" in found.err


def test_what_a_wrong_log_leaves_undetermined_is_no_advice_to_move_otherwise(shell: Shell) -> None:
    """Angles from 0 to 2 pi: few rows are left between the leaps, and the leaps are the cause."""
    turned = "awk -F, -v OFS=, 'NR > 1 { for (k = 2; k < 4; k++) while ($k < 0) $k += 2 * p } 1'"
    made = shell(f"{LOG} --format csv | cut -d, -f-5 | {turned} p=3.14159265358979 > log.csv")
    assert made.status == 0, made.err
    found = shell("scarid identify --robot planar2-gravity log.csv > parameters.csv")
    assert found.status == 65
    assert "undetermined; mend the log first: wraps: q1 leaps by 2 pi in " in found.err
    assert "excites" not in found.err
