"""What a robot's file says of its logs holds for every reader; no robot is assumed for others."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scarid_cli.algorithms.keys.lines import line_of
from tests.conftest import Result, refused

Run = Callable[..., Result]
ROBOTS = Path(__file__).parents[2] / "scarid_cli" / "algorithms" / "robots"
LOG = """
[log]
rate = 500.0
positions = "motor"
torques = "current"
columns = { q1 = "enc_a", q2 = "enc_b", tau1 = "i_a", tau2 = "i_b" }
"""
MOTORS = (
    "gear_ratio = 80.0\ntorque_constant = 0.06\n",
    "gear_ratio = -50.0\ntorque_constant = 0.04\n",
)


def described(folder: Path, log: str = LOG) -> Path:
    """The robot of the paper, driven by two geared motors."""
    first, *parts = (ROBOTS / "scara2.toml").read_text().split("[[joint]]\n")
    joints = "".join(f"[[joint]]\n{motor}{part}" for motor, part in zip(MOTORS, parts, strict=True))
    path = folder / "geared.toml"
    path.write_text(first + log + joints)
    return path


def recorded(scarid: Run, folder: Path) -> tuple[Path, Path]:
    """A log at the joints, and the same as the motors' encoders and amplifiers give it."""
    joints, motors = folder / "joints.csv", folder / "motors.csv"
    scarid("trajgen", "-q", "--seed", "1", "-o", folder / "t.parquet")
    scarid("simulate", "-q", folder / "t.parquet", "-o", joints)
    names = joints.read_text().partition("\n")[0].split(",")
    rows = np.loadtxt(joints, delimiter=",", skiprows=1)
    q1, q2, tau1, tau2 = (rows[:, names.index(name)] for name in ("q1", "q2", "tau1", "tau2"))
    made = np.column_stack((80.0 * q1, -50.0 * q2, tau1 / (80.0 * 0.06), tau2 / (-50.0 * 0.04)))
    np.savetxt(motors, made, fmt="%.17g", delimiter=",", header="enc_a,enc_b,i_a,i_b", comments="")
    return joints, motors


@pytest.mark.parametrize(
    "command", ["info --json", "resample --rate 100", "filter --cutoff 20", "differentiate"]
)
def test_stages_convert_a_raw_log_by_the_robot_of_the_environment(
    command: str, scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those that need no robot take it as an option where no robot follows them in a pipe."""
    robot, (_, motors) = described(tmp_path), recorded(scarid, tmp_path)
    converted = tmp_path / "converted.csv"
    scarid("convert", "--robot", robot, motors, "-o", converted)
    made = scarid(*command.split(), converted).out.replace("converted.csv", "motors.csv")
    if command.startswith(("info", "resample")):
        stated = scarid(*command.split(), "--robot", robot, motors)
        assert without_robot(stated.out) == without_robot(made)
    monkeypatch.setenv("SCARID_ROBOT", str(robot))
    raw = scarid(*command.split(), motors)
    assert raw.status == 0, raw.err
    assert without_robot(raw.out) == without_robot(made)
    assert f"{motors}: columns, units and motors by [log] of {robot}" in raw.err


def without_robot(text: str) -> str:
    """Of CSV nobody knows the robot, nor the units of its torques."""
    return re.sub(r'"(robot|unit|bytes|sha256)": ("[^"]*"|null)', "", text)


def test_every_reader_converts_a_raw_log_as_convert_does(scarid: Run, tmp_path: Path) -> None:
    robot, (_, motors) = described(tmp_path), recorded(scarid, tmp_path)
    converted = tmp_path / "converted.parquet"
    scarid("convert", "--robot", robot, motors, "-o", converted)
    for command in (["check"], ["identify"], ["validate", "--parameters", "apriori"]):
        raw = scarid(*command, "--robot", robot, motors)
        made = scarid(*command, "--robot", robot, converted)
        assert (raw.status, raw.out) == (made.status, made.out)
        assert f"{motors}: columns, units and motors by [log] of {robot}" in raw.err
        assert "by [log]" not in made.err


def test_a_log_by_our_names_is_not_converted_twice(scarid: Run, tmp_path: Path) -> None:
    robot, (joints, _) = described(tmp_path), recorded(scarid, tmp_path)
    found = scarid("identify", "--robot", robot, joints)
    same = scarid("identify", "--robot", "scara2", joints)
    assert found.out == same.out
    assert "motors" not in found.err


def test_where_names_cannot_tell_it_is_said_what_was_taken(scarid: Run, tmp_path: Path) -> None:
    robot = described(tmp_path, re.sub("columns.*\n", "", LOG))
    joints, _ = recorded(scarid, tmp_path)
    found = scarid("identify", "--robot", robot, joints)
    assert f"{joints}: taken as positions and torques of the joints" in found.err
    converted = tmp_path / "converted.parquet"
    scarid("convert", "--robot", robot, joints, "-o", converted)
    assert "taken as" not in scarid("identify", "--robot", robot, converted).err


@pytest.mark.parametrize("joints", [1, 3, 6])
@pytest.mark.parametrize("command", ["identify", "check"])
def test_no_robot_is_assumed_for_another_number_of_joints(
    command: str, joints: int, scarid: Run, tmp_path: Path
) -> None:
    log = tmp_path / "log.csv"
    names = ["t", *(f"{x}{i + 1}" for x in ("q", "tau") for i in range(joints))]
    rows = np.column_stack((np.arange(50) / 100.0, np.zeros((50, 2 * joints))))
    np.savetxt(log, rows, delimiter=",", header=",".join(names), comments="")
    many = f"{joints} joint{'s' if joints > 1 else ''}"
    words = f"{log}: no robot is stated for this table of {many}; state it with --robot"
    refused(scarid(command, log), 2, words)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("torques =", "torque =", "torque is not a key of [log] (is it torques?); its keys are"),
        ("torque_constant = 0.04", "torque_constnat = 0.04", "torque_constnat is not a key of [[j"),
        ("[log]", "[logs]", "logs is not a key of a robot (is it log?)"),
        ("title =", "titel =", "titel is not a key of a robot (is it title?)"),
    ],
)
def test_a_typo_has_its_line_and_the_keys_that_are_valid_there(
    old: str, new: str, words: str, scarid: Run, tmp_path: Path
) -> None:
    robot = described(tmp_path)
    lines = robot.read_text().splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith(old))
    lines[at] = lines[at].replace(old, new)
    robot.write_text("\n".join(lines))
    found = scarid("robot", "check", robot)
    refused(found, 2, f"{robot}, line {at + 1}: not a robot description: {words}")


def test_a_key_is_looked_for_in_its_own_table() -> None:
    text = 'a = 1\n[log]\n"b" = 2\n[[joint]]\na = 3\n[c.d]\n'
    assert [line_of(text, *x) for x in (("", "a"), ("joint", "a"), ("log", "b"))] == [1, 5, 3]
    assert line_of(text, "", "c") == 6
    assert line_of(text, "log", "a") is None


@pytest.mark.parametrize("name", ["actual_current_0", "motor 1 amps", "CurrentAxis1"])
def test_a_current_is_called_a_torque_only_with_its_constant(
    name: str, scarid: Run, tmp_path: Path
) -> None:
    log = tmp_path / "log.csv"
    log.write_text(f"t,q1,{name}\n0,0,2\n0.1,1,4\n")
    mapped = ["convert", "--map", f"tau1={name}", log]
    refused(scarid(*mapped), 2, f"--map tau1={name}: by its name a current", "--unit 'tau1=0.05")
    stated = scarid(*mapped, "--unit", "tau1=0.5 N m")
    assert stated.out.splitlines() == ["t,q1,tau1", "0,0,1", "0.1,1,2"]


def test_the_values_of_a_description_predict_the_torques(scarid: Run, tmp_path: Path) -> None:
    joints, _ = recorded(scarid, tmp_path)
    found = scarid("validate", "--robot", "scara2", "--parameters", "apriori", joints)
    assert found.status == 0
    header, *rows = (line.split(",") for line in found.out.splitlines())
    assert [float(row[header.index("r2")]) for row in rows] == pytest.approx([1.0, 1.0], abs=0.01)
    unknown = tmp_path / "unknown.toml"
    unknown.write_text(re.sub("apriori = .*", "", described(tmp_path).read_text()))
    assert scarid("validate", "--robot", unknown, "--parameters", "apriori", joints).status == 2
