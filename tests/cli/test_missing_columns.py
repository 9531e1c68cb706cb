"""A column that a command needs and the table lacks: which one, and the command that makes it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result

Run = Callable[..., Result]


@pytest.mark.parametrize("command", ["identify", "validate"])
def test_a_motion_without_torques_is_reported(
    command: str, scarid: Run, samples: Path, tmp_path: Path
) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t,q1,q2,dq1,dq2,ddq1,ddq2\n0,1,2,3,4,5,6\n0.1,1,2,3,4,5,6\n")
    option = ["--parameters", samples / "scara2.parameters.csv"] if command == "validate" else []
    result = scarid(command, *option, log)
    assert result.status == 65
    assert "column tau1: found no torques, expected tau1" in result.err
    assert result.err.count("\n") == 1


def test_a_robot_with_more_joints_than_the_log_is_reported(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("t,q1,dq1,ddq1,tau1\n0,1,2,3,4\n0.1,1,2,3,4\n")
    result = scarid("identify", "--robot", "scara2", log)
    assert result.status == 65
    assert "column q2" in result.err
    assert "for robot scara2 (another: --robot)" in result.err


@pytest.mark.parametrize(
    ("command", "missing", "remedy"),
    [
        ("validate --parameters PARAMETERS", "dq1", "estimate it with `scarid differentiate`"),
        (
            "validate --parameters PARAMETERS",
            "tau1",
            "rename yours with `scarid convert --map tau1=NAME`",
        ),
        ("differentiate", "q1", "rename yours with `scarid convert --map q1=NAME`"),
        ("simulate", "q1_ref", "make a trajectory with `scarid trajgen`"),
        ("simulate", "dq1_ref", "make a trajectory with `scarid trajgen`"),
    ],
)
def test_a_column_that_is_missing_is_to_be_made_by_the_command_that_makes_it(
    command: str, missing: str, remedy: str, scarid: Run, tmp_path: Path, samples: Path
) -> None:
    names = ["t", *(f"{x}{i}" for x in ("q", "dq", "ddq", "tau") for i in (1, 2))]
    names += [f"{x}{i}_ref" for x in ("q", "dq", "ddq") for i in (1, 2)]
    log = tmp_path / "log.csv"
    kept = [name for name in names if name != missing]
    rows = "".join(",".join([str(k / 100)] * len(kept)) + "\n" for k in range(20))
    log.write_text(",".join(kept) + "\n" + rows)
    words = command.replace("PARAMETERS", str(samples / "scara2.parameters.csv")).split()
    result = scarid(*words, log)
    assert result.status == 65
    assert f"column {missing}: " in result.err
    assert remedy in result.err


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("identify SAMPLES/scara2.parameters.csv", "this is a table of parameters"),
        ("trajgen --duration 3 then identify", "this is a trajectory: follow it with"),
        ("compare SAMPLES/scara2.csv SAMPLES/scara2.csv", "give the table that `scarid identify`"),
        (
            "report --published SAMPLES/scara2.csv SAMPLES/scara2.parameters.csv",
            "which a table of published values has",
        ),
        ("simulate SAMPLES/scara2.parameters.csv", "which an excitation trajectory has"),
    ],
)
def test_another_kind_of_table_is_called_what_it_is(
    line: str, told: str, scarid: Run, samples: Path
) -> None:
    result = scarid(*line.replace("SAMPLES", str(samples)).split())
    assert result.status == 65
    assert told in result.err


def test_info_says_how_the_columns_of_a_log_get_the_expected_names(
    shell: Run,
) -> None:
    """Any table with a time column may be a trace of parameters."""
    found = shell("printf 't,shoulder\\n0,1\\n0.1,2\\n' | scarid info")
    assert "trace (or a log whose columns have other names: `scarid convert --map`)" in found.out
