"""Logs as labs have them, turned into tables of ours."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from conftest import Result

Shell = Callable[..., Result]


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


@pytest.mark.parametrize(
    ("command", "status", "told"),
    [
        ("--map q1 LOG", 2, "--map q1: write NAME=VALUE"),
        ("--map q3=nothing LOG", 2, "no column 'nothing'"),
        ("--map q1=q2 LOG", 2, "two columns would be called 'q1'"),
        ("--unit q1=furlong LOG", 2, "unknown unit"),
        ("--unit x=deg LOG", 2, "no column 'x'"),
        ("--rate 100 LOG", 2, "has a time column t"),
        ("--rate 0 LOG", 2, "--rate must be positive"),
        ("--separator ab LOG", 2, "one character"),
        ("--decimal-comma LOG", 2, "needs a --separator"),
        ("nowhere.npz", 2, "no such file"),
        ("bad.npz", 65, "not a readable .npz file"),
        ("bad.mat", 65, "not a readable .mat file"),
        ("uneven.npz", 65, "expected arrays of one length"),
    ],
)
def test_what_cannot_be_is_told(
    command: str, status: int, told: str, shell: Shell, tmp_path: Path
) -> None:
    for name in ("bad.npz", "bad.mat"):
        (tmp_path / name).write_text("this is neither")
    np.savez(tmp_path / "uneven.npz", t=np.arange(3.0), q=np.arange(4.0))
    result = shell(f"scarid convert {command.replace('LOG', '$SAMPLES/scara2.csv')}")
    assert result.status == status
    assert told in result.err
    assert len(result.err.splitlines()) == 1
