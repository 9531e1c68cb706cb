"""Logs as labs have them, turned into tables of ours."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from conftest import Result, refused

Shell = Callable[..., Result]
Run = Callable[..., Result]


def test_names_units_customs_and_a_missing_header(shell: Shell) -> None:
    result = shell(
        r"printf '0,5;180;25\n1;-90;2,5\n' | scarid convert --separator ';' --decimal-comma"
        " --header time,pos,tau1 --map t=time,q1=pos --unit 'q*=deg' --unit tau1='mN m'"
    )
    header, *rows = result.out.splitlines()
    assert header == "t,q1,tau1"
    values = [[float(x) for x in row.split(",")] for row in rows]
    np.testing.assert_allclose(values, [[0.5, np.pi, 0.025], [1.0, -np.pi / 2.0, 0.0025]])


def test_tabs_and_a_clock_of_ours(shell: Shell) -> None:
    result = shell(r"printf 'q1\ttau1\n1\t2\n3\t4\n' | scarid convert --separator '\t' --rate 200")
    assert result.out == "t,q1,tau1\n0,1,2\n0.005,3,4\n"


def test_the_bits_do_not_depend_on_how_bytes_arrive(shell: Shell) -> None:
    rows = ";".join(["0,125"] * 3)
    result = shell(
        f"for i in 1 2 3; do echo '{rows}'; sleep 0.05; done |"
        " scarid convert --separator ';' --decimal-comma --header t,q1,x"
    )
    assert result.out == "t,q1,x\n" + 3 * "0.125,0.125,0.125\n"


def test_every_map_counts(shell: Shell) -> None:
    result = shell("scarid convert --map q8=q1 --map q9=q2,tau9=tau1 $SAMPLES/scara2.csv | head -1")
    assert result.out.startswith("t,q8,q9,tau9,tau2,")


@pytest.mark.parametrize("extension", ["npz", "mat"])
def test_arrays_become_columns(extension: str, shell: Shell, tmp_path: Path) -> None:
    arrays = {"t": np.arange(3) * 0.01, "q": np.arange(6.0).reshape(3, 2), "tau": np.ones((2, 3))}
    path = tmp_path / f"log.{extension}"
    if extension == "npz":
        np.savez(path, **arrays)
    else:
        scipy.io.savemat(path, {**arrays, "note": "a text"})
    result = shell(f"scarid convert {path}")
    assert result.out == "t,q1,q2,tau1,tau2\n0,0,1,1,1\n0.01,2,3,1,1\n0.02,4,5,1,1\n"


def test_fields_of_structures_become_columns(shell: Shell, tmp_path: Path) -> None:
    """As loggers in MATLAB and Simulink write them."""
    signals = {"values": np.ones((2, 3)), "label": "torques"}
    log = {"time": np.arange(3) * 0.01, "q": np.arange(6.0).reshape(3, 2), "signals": signals}
    scipy.io.savemat(tmp_path / "log.mat", {"log": log, "rate": 100.0})
    renamed = "--map t=log.time --map 'q*=log.q' --map 'tau*=log.signals.values'"
    result = shell(f"scarid convert {renamed} log.mat")
    assert result.out == "t,q1,q2,tau1,tau2\n0,0,1,1,1\n0.01,2,3,1,1\n0.02,4,5,1,1\n"


def test_map_names_the_arrays_of_the_log_among_others(shell: Shell, tmp_path: Path) -> None:
    """As in the files of benchmarks with a part to test and one to validate."""
    arrays = {"t_test": np.arange(3) * 0.01, "q_test": np.ones((2, 3)), "u_test": np.ones((2, 3))}
    others = {"q_val": np.ones((2, 4)), "poses": np.ones((4, 4, 3)), "z": np.ones(3) * 1j}
    scipy.io.savemat(tmp_path / "log.mat", arrays | others)
    result = shell("scarid convert --map 't=t_test,q*=q_test,tau1=u_test1' log.mat")
    assert result.out == "t,q1,q2,tau1,u_test2\n0,1,1,1,1\n0.01,1,1,1,1\n0.02,1,1,1,1\n"
    assert "log.mat: left out q_val, poses, z, which --map does not name" in result.err
    message = "found q_test (3 x 2), q_val (4 x 2), expected arrays of one length; name those"
    refused(shell("scarid convert --map 'q*=q_test,a=q_val1' log.mat"), 65, message)


@pytest.mark.parametrize("name", ["log.mat", "log.npz", "a log.MCAP"])
def test_a_file_that_only_convert_reads_names_it(name: str, shell: Shell, tmp_path: Path) -> None:
    (tmp_path / name).write_bytes(b"\0" * 200)
    result = shell(f"scarid identify --robot scara2 '{name}'")
    quoted = name if name != "a log.MCAP" else f"'{name}'"
    advice = f"{name}: convert it first: `scarid convert --robot scara2 {quoted} -o log.parquet`"
    refused(result, 65, advice)


@pytest.mark.parametrize("text", ['{"t": 0.0, "q1": 1.0}\n', '[\n  {"t": 0.0}\n]\n'])
def test_json_is_for_convert(text: str, shell: Shell, tmp_path: Path) -> None:
    """A line of it looks like a line of CSV."""
    (tmp_path / "log.json").write_text(text)
    for command in ("filter", "info"):
        advice = "log.json: JSON; convert it first: `scarid convert log.json"
        refused(shell(f"scarid {command} log.json"), 65, advice)


@pytest.mark.parametrize(
    ("command", "status", "message"),
    [
        ("--map q1 LOG", 2, "--map q1: write NAME=VALUE"),
        ("--map q3=nothing LOG", 2, "no column 'nothing'"),
        ("--map q1=q2 LOG", 2, "two columns would be called 'q1'"),
        ("--map q8=q1,q9=q1 LOG", 2, "cannot become both 'q8' and 'q9'; give it one new name"),
        ("--map q9=q1 --map q8=q1 LOG", 2, "cannot become both 'q9' and 'q8'"),
        ("--map q9=q1 --map q9=q2 LOG", 2, "'q9' is given twice, for 'q1' and for 'q2'"),
        ("--unit q1=furlong LOG", 2, "unknown unit"),
        ("--unit x=deg LOG", 2, "no column 'x'"),
        ("--rate 100 LOG", 2, "has a time column t"),
        ("--rate 0 LOG", 2, "'--rate': give a finite number above 1e-09"),
        ("--separator ab LOG", 2, "one character"),
        ("--decimal-comma LOG", 2, "needs a --separator"),
        ("nowhere.npz", 2, "no such file"),
        ("bad.npz", 65, "not a readable .npz file"),
        ("bad.mat", 65, "not a readable .mat file"),
        ("uneven.npz", 65, "expected arrays of one length"),
    ],
)
def test_what_cannot_be_is_reported(
    command: str, status: int, message: str, shell: Shell, tmp_path: Path
) -> None:
    for name in ("bad.npz", "bad.mat"):
        (tmp_path / name).write_text("this is neither")
    np.savez(tmp_path / "uneven.npz", t=np.arange(3.0), q=np.arange(4.0))
    result = shell(f"scarid convert {command.replace('LOG', '$SAMPLES/scara2.csv')}")
    refused(result, status, message)


ROBOT = """
title = "two axes, the motor of the second turns with the first"
[log]
rate = 100.0
positions = "motor"
torques = "current"
columns = { q1 = "enc1", q2 = "enc2", tau1 = "amp1", tau2 = "amp2" }
units = { "q?" = "0.001 rad", "tau?" = "mA" }
[[joint]]
type = "revolute"
gear_ratio = 50.0
torque_constant = 0.1
zero = 0.3
[[joint]]
type = "revolute"
gear_ratio = -20.0
torque_constant = 0.2
[[coupling]]
joints = [1, 2]
ratio = 4.0
[[parameter]]
name = "Fv1"
term = "viscous"
joint = 1
unit = "N m s/rad"
apriori = 0.0
"""


def test_a_log_of_motors_becomes_one_of_joints(shell: Shell, tmp_path: Path) -> None:
    """Forwards by hand: motor 1 turns 50 q1, motor 2 turns 4 q1 - 20 q2; work is the same."""
    (tmp_path / "robot.toml").write_text(ROBOT)
    q = np.array([[0.1, -0.2, 0.7], [0.5, 0.0, -1.0]])
    motors = np.array([50.0 * (q[0] - 0.3), 4.0 * (q[0] - 0.3) - 20.0 * q[1]])
    amperes = np.array([[1.0, -2.0, 0.5], [3.0, 0.0, 1.0]])
    m1, m2 = 0.1 * amperes[0], 0.2 * amperes[1]
    tau = np.array([50.0 * m1 + 4.0 * m2, -20.0 * m2])
    columns = (*(motors / 0.001), *(1000.0 * amperes))
    np.savetxt(
        tmp_path / "log.csv",
        np.transpose(columns),
        fmt="%.17g",
        delimiter=",",
        header="enc1,enc2,amp1,amp2",
        comments="",
    )
    (tmp_path / "part.csv").write_text("enc1,enc2,amp1\n1,2,3\n")
    refused = shell("scarid identify --robot robot.toml part.csv")
    assert "rename them with `scarid convert --robot robot.toml --format arrow" in refused.err
    result = shell("scarid convert --robot robot.toml log.csv")
    assert result.status == 0, result.err
    header, *rows = result.out.splitlines()
    assert header == "t,q1,q2,tau1,tau2"
    found = np.array([[float(x) for x in row.split(",")] for row in rows]).T
    np.testing.assert_allclose(found, [[0.0, 0.01, 0.02], *q, *tau], rtol=1e-12, atol=1e-12)


def test_the_zero_of_a_joint_is_added_to_its_positions(shell: Shell, tmp_path: Path) -> None:
    motors = """[log]
rate = 100.0
positions = "motor"
torques = "current"
columns = { q1 = "enc1", q2 = "enc2", tau1 = "amp1", tau2 = "amp2" }
units = { "q?" = "0.001 rad", "tau?" = "mA" }
"""
    (tmp_path / "robot.toml").write_text(ROBOT.replace(motors, ""))
    (tmp_path / "log.csv").write_text("t,q1,q2,dq1,tau1,tau2\n0,1,2,3,4,5\n")
    result = shell("scarid convert --robot robot.toml log.csv")
    assert result.out.splitlines()[1] == "0,1.3,2,3,4,5", result.err


def test_a_robot_whose_logs_are_not_described_is_stated(shell: Shell) -> None:
    result = shell(
        "scarid convert --robot scara2 $SAMPLES/scara2.csv -o log.parquet &&"
        " scarid info log.parquet | grep ^robot && scarid convert log.parquet |"
        " cmp - $SAMPLES/scara2.csv"
    )
    assert (result.status, result.out) == (0, "robot     scara2\n"), result.err


@pytest.mark.parametrize(
    ("command", "status", "message"),
    [
        ("--robot robot.toml log.csv", 2, "no column 'enc2' to rename; it has enc1"),
        ("--robot robot.toml --map q2=other log.csv", 65, "name the columns of all motors"),
    ],
)
def test_a_log_that_does_not_fit_its_robot_is_reported(
    command: str, status: int, message: str, shell: Shell, tmp_path: Path
) -> None:
    robot = (
        ROBOT
        if "other" not in command
        else ROBOT.replace(', q2 = "enc2"', "").replace(', tau2 = "amp2"', "")
    )
    (tmp_path / "robot.toml").write_text(robot)
    (tmp_path / "log.csv").write_text("enc1,amp1,other\n1,2,3\n4,5,6\n")
    refused(shell(f"scarid convert {command}"), status, message)


@pytest.mark.parametrize("extension", ["npz", "mat"])
def test_the_history_has_the_digest_of_an_archive(
    extension: str, shell: Shell, tmp_path: Path
) -> None:
    path = tmp_path / f"log.{extension}"
    arrays = {"t": np.arange(3) * 0.01, "q1": np.arange(3.0)}
    np.savez(path, **arrays) if extension == "npz" else scipy.io.savemat(path, arrays)
    result = shell(f"scarid convert {path} -o log.parquet && scarid info log.parquet")
    assert hashlib.sha256(path.read_bytes()).hexdigest() in result.out


def test_wraps_and_glitches_are_taken_out_and_told(shell: Shell, tmp_path: Path) -> None:
    t = np.arange(400) / 100.0
    q, tau = 5.0 * np.sin(1.5 * t), 3.0 * np.cos(t)
    wrapped, spiked = (q + np.pi) % (2.0 * np.pi) - np.pi, tau.copy()
    spiked[[50, 300]] = 99.0
    np.savetxt(tmp_path / "log.csv", np.column_stack((t, wrapped, spiked)), fmt="%.17g",
               delimiter=",", header="t,angle,load", comments="")  # fmt: skip
    named = "scarid convert --map q1=angle,tau1=load log.csv"
    done = shell(f"{named} --unwrap --despike")
    first = np.flatnonzero(np.abs(np.diff(wrapped)) > np.pi)[0] + 2
    assert f"angle: unwrapped {np.sum(np.abs(np.diff(wrapped)) > np.pi)} leaps of" in done.err
    assert f"of 6.28319, the first in row {first}" in done.err
    assert "load: took out the glitches in rows 51, 301" in done.err
    found = np.genfromtxt(done.out.splitlines(), delimiter=",", names=True)
    np.testing.assert_allclose(found["q1"], q, atol=1e-9)
    assert np.flatnonzero(np.isnan(found["tau1"])).tolist() == [50, 300]
    np.testing.assert_array_equal(np.delete(found["tau1"], [50, 300]), np.delete(tau, [50, 300]))
    assert shell(named).err.count("leaps") == 0


@pytest.mark.parametrize("extension", ["npz", "mat"])
def test_single_numbers_of_an_archive_are_told(extension: str, scarid: Run, tmp_path: Path) -> None:
    """Such as the period of a log without a clock."""
    path = tmp_path / f"log.{extension}"
    arrays = {"q": np.zeros((5, 2)), "tau": np.ones((5, 2)), "dt": np.array(0.005)}
    np.savez(path, **arrays) if extension == "npz" else scipy.io.savemat(path, arrays)
    told = scarid("convert", path, "-o", tmp_path / "out.csv").err
    assert "single numbers are left out: dt = 0.005\n" in told
    assert "no clock: give --rate HZ" in told
