"""A pipe ends in the same estimates in CSV, Arrow, Parquet and one process."""

from __future__ import annotations

import csv

import pytest
from conftest import Shell

# Sixteen digits carry a number; the sampling period of CSV is that of its first interval.
AGREE = 1e-9
PIPES = [
    "differentiate",
    "filter | differentiate --method p2smd",
    "filter | differentiate --method ed-fir",
    "differentiate --method rts",
    "filter --cutoff 8 --zero-phase | differentiate --method savgol",
    "differentiate --method kalman-lag --set delay=0.05",
]


def values(text: str) -> dict[str, list[float]]:
    """The numbers of a table of parameters."""
    rows = csv.DictReader(text.splitlines())
    names = ("estimate", "standard_error", "robust_error", "low", "high")
    return {row["parameter"]: [float(row[name]) for name in names] for row in rows}


@pytest.mark.parametrize("pipe", PIPES)
def test_csv_arrow_parquet_and_one_process_agree(pipe: str, shell: Shell) -> None:
    stages = [*pipe.split(" | "), "identify --robot scara2 --align"]
    first, *rest = stages
    own = f"{first} $SAMPLES/scara2.csv"
    csv_pipe = " | ".join(f"scarid {stage}" for stage in (own, *rest))
    files = " && ".join(
        f"scarid {stage} {'' if k == 1 else f'{k - 1}.parquet'} -o {k}.parquet"
        for k, stage in enumerate((own, *rest), start=1)
    )
    results = [
        shell(csv_pipe),
        shell(f"export SCARID_FORMAT=arrow; {csv_pipe} | scarid convert --format csv"),
        shell(f"{files} && scarid convert {len(stages)}.parquet"),
        shell(f"scarid {' then '.join((own, *rest))}"),
    ]
    first, *others = results
    assert first.status == 0, first.err
    for other in others:
        assert other.status == 0, other.err
        for name, row in values(first.out).items():
            assert row == pytest.approx(values(other.out)[name], rel=AGREE, abs=AGREE)


def test_one_command_on_a_measurement_is_its_printed_pipe_in_csv(shell: Shell) -> None:
    once = shell("scarid identify --robot scara2 $SAMPLES/scara2.csv")
    (printed,) = (line for line in once.err.splitlines() if "the same as: " in line)
    pipe = printed.partition("the same as: ")[2].replace("--format arrow", "--format csv")
    again = shell(pipe)
    assert again.status == 0, again.err
    for name, row in values(once.out).items():
        assert row == pytest.approx(values(again.out)[name], rel=AGREE, abs=AGREE)


def test_a_table_of_another_program_keeps_its_columns(shell: Shell) -> None:
    """Of these names, but with values that are none of ours."""
    made = shell("printf 't,q1,passed_bandwidth\\n0,1,-3\\n1,2,-3\\n' | scarid convert")
    assert made.out == "t,q1,passed_bandwidth\n0,1,-3\n1,2,-3\n"


def test_what_was_fitted_beside_survives_tools_that_leave_rows_out(shell: Shell) -> None:
    """The bandwidth stands in every row."""
    whole = "scarid differentiate $SAMPLES/scara2.csv"
    late = shell(f"{whole} | sed '2,100d' | scarid info - ")
    assert "bandwidth" in late.out, late.out
