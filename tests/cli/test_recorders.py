"""Text logs and tables of other programs, found from their first lines and columns."""

from __future__ import annotations

import gzip
import importlib
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
import pytest
from conftest import Result, refused
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.cli import convert
from scarid_cli.io.bytesource import ByteSource, unpacked
from scarid_cli.stages.conversion.recorders import OTHER_NAMES, RECORDERS

Run = Callable[..., Result]

TEXTS = {
    "semicolons and decimal commas": "t;q1;tau1\n0;0,5;2\n0,01;1,5;-3e1\n",
    "tabs": "t\tq1\ttau1\n0\t0.5\t2\n0.01\t1.5\t-30\n",
    "white space, no last line break": "t  q1  tau1\n 0 0.5 2\n 0.01   1.5 -30",
    "bars": "t|q1|tau1\n0|0.5|2\n0.01|1.5|-30\n",
    "numpy.savetxt": "# a note\n# t q1 tau1\n0.0 0.5 2.0\n1e-2 1.5 -3e1\n",
    "MATLAB's comment": "% t;q1;tau1\n0;0.5;2\n0.01;1.5;-30\n",
    "tabs and decimal commas": "t\tq1\ttau1\r\n0\t0,5\t2\r\n0,01\t1,5\t-30\r\n",
    "spaces after commas": "t, q1, tau1\n0, 0.5, 2\n0.01, 1.5, -30\n",
    "units in names": "t_ms,q1 [deg],tau1 (mNm)\n0,28.64788975654116,2e3\n"
    "10,85.94366926962348,-3e4\n",
}


@pytest.mark.parametrize("kind", TEXTS)
@pytest.mark.parametrize("name", ["log.csv", "log.csv.gz", "log.utf-16", "log.utf-16-be.gz"])
def test_the_notation_is_found_and_told(kind: str, name: str, scarid: Run, tmp_path: Path) -> None:
    path = tmp_path / name
    data = TEXTS[kind].encode()
    if "utf-16" in name:  # as Excel and PowerShell write text
        data = f"\ufeff{TEXTS[kind]}".encode("utf-16-be" if "be" in name else "utf-16-le")
    path.write_bytes(gzip.compress(data) if name.endswith(".gz") else data)
    result = scarid("convert", path)
    assert result.status == 0, result.err
    header, *rows = result.out.splitlines()
    assert header == "t,q1,tau1"
    values = [[float(x) for x in row.split(",")] for row in rows]
    np.testing.assert_allclose(values, [[0.0, 0.5, 2.0], [0.01, 1.5, -30.0]], atol=1e-12)
    assert ("read with" in result.err or "q1 from q1 [deg] (deg)" in result.err) != (
        kind == "spaces after commas"
    )


def test_the_unit_in_a_renamed_column_counts_unless_another_is_given(
    scarid: Run, tmp_path: Path
) -> None:
    (tmp_path / "log.csv").write_text("time [ms],shoulder (deg),e_m,x_y\n0,180,1,2\n10,90,2,3\n")
    words = ("convert", tmp_path / "log.csv", "--map", "q1=shoulder (deg),q2=e_m,q3=x_y")
    result = scarid(*words)
    assert result.out == "t,q1,q2,q3\n0,3.141592653589793,1,2\n0.01,1.5707963267948966,2,3\n"
    assert "column 'shoulder (deg)' becomes q1, from deg as its name says" in result.err
    assert scarid(*words, "--unit", "q1=rad").out.startswith("t,q1,q2,q3\n0,180,1,2\n")


@pytest.mark.parametrize(("module", "tool"), [("bz2", "bunzip2"), ("lzma", "unxz")])
def test_what_is_packed_otherwise_names_its_tool(
    module: str, tool: str, scarid: Run, tmp_path: Path
) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(importlib.import_module(module).compress(b"t,q1\n0,1\n"))
    refused(scarid("check", path), 65, f"unpack it with `{tool}`")


@settings(max_examples=50)
@given(text=st.text(max_size=200), order=st.sampled_from(["le", "be"]), most=st.integers(1, 9))
def test_text_in_utf_16_is_the_same_however_it_arrives(text: str, order: str, most: int) -> None:
    data = f"\ufeff{text}".encode(f"utf-16-{order}")
    read, write = os.pipe()
    with os.fdopen(write, "wb") as pipe:
        pipe.write(data)
    source = unpacked(ByteSource(read, "log"))
    found = b""
    while part := source.read_some(most):
        assert len(part) <= most
        found += part
    source.close()
    assert found.decode() == text


def test_slow_bytes_of_white_space_make_the_same_table(shell: Run) -> None:
    result = shell(
        "for i in 1 2 3; do printf ' 0.5'; sleep 0.05; printf '  1\\n%s' '2.5   3'; sleep 0.05;"
        " echo; done | scarid convert --header q1,q2"
    )
    assert result.out == "q1,q2\n" + 3 * "0.5,1\n2.5,3\n"


def test_a_zipped_log_is_read_by_every_command(shell: Run) -> None:
    result = shell(
        "gzip -c $SAMPLES/scara2.csv > log.csv.gz && scarid differentiate log.csv.gz > a.csv &&"
        " scarid differentiate $SAMPLES/scara2.csv | cmp - a.csv"
    )
    assert result.status == 0, result.err


def test_a_zipped_stream_is_the_table_in_it(shell: Run) -> None:
    result = shell(
        "scarid convert $SAMPLES/scara2.csv -o log.arrows && gzip -k log.arrows &&"
        " scarid convert log.arrows > a.csv && scarid convert log.arrows.gz | cmp - a.csv"
    )
    assert result.status == 0, result.err


NAMES = {
    "ur-rtde": (
        "timestamp actual_q_0 actual_q_1 actual_qd_0 actual_qd_1 target_q_0 target_q_1 io\n"
        "100.5 1 2 3 4 5 6 0\n100.502 1 2 3 4 5 6 0\n",
        "t,q1,q2,dq1_measured,dq2_measured,q1_ref,q2_ref,io\n100.5,1,2,3,4,5,6,0\n",
    ),
    "libfranka": (
        "time, success_rate, state.q[0], state.q[1],state.tau_J[0],state.tau_J[1]\n"
        "4500,1,1,2,3,4\n4501,1,1,2,3,4\n",
        "t,success_rate,q1,q2,tau1,tau2\n4.5,1,1,2,3,4\n",
    ),
    "plotjuggler": (
        "__time,/a/joint_states/elbow/position,/a/joint_states/base/position,"
        "/a/joint_states/base/effort,/a/joint_states/elbow/effort\n0.5,1,2,3,4\n0.6,1,2,3,4\n",
        "t,q2,q1,tau1,tau2\n0.5,1,2,3,4\n",
    ),
    "plotjuggler by number": (
        "__time,/s/position[0],/s/position[1],/s/velocity[0],/s/velocity[1]\n0.5,1,2,3,4\n1,2,3,4,5\n",
        "t,q1,q2,dq1_measured,dq2_measured\n0.5,1,2,3,4\n",
    ),
}


@pytest.mark.parametrize("kind", NAMES)
def test_recorders_are_known_by_their_columns(kind: str, scarid: Run, tmp_path: Path) -> None:
    text, expected = NAMES[kind]
    (tmp_path / "log.csv").write_text(text)
    found = scarid("convert", tmp_path / "log.csv", "--joints", "base,elbow")
    assert found.out.startswith(expected), found.err
    name = kind.partition(" ")[0]
    assert f"columns of {name}" in found.err
    told = scarid("convert", tmp_path / "log.csv", "--joints", "base,elbow", "--from", name)
    assert told.out == found.out


@pytest.mark.parametrize("clock", ["date,2026-11-24 10:00:0%", "stamp,2026-11-24T10:00:0%+01:00"])
def test_dates_become_seconds_since_the_first_one(clock: str, scarid: Run, tmp_path: Path) -> None:
    name, _, form = clock.partition(",")
    (log := tmp_path / "log.csv").write_text(
        f"{name},pos1,torque1\n"
        + "".join(f"{form.replace('%', f'{k}.25')},{k},2\n" for k in range(3))
    )
    assert scarid("convert", log).out == "t,q1,tau1\n0,0,2\n1,1,2\n2,2,2\n"
    pyarrow.parquet.write_table(pyarrow.csv.read_csv(log), stamped := tmp_path / "log.parquet")
    assert scarid("convert", stamped).out == "t,q1,tau1\n0,0,2\n1,1,2\n2,2,2\n"
    for wrong, found in (("soon", "'soon'"), ("", "no value")):
        log.write_text(log.read_text().replace(form.replace("%", "2.25"), wrong))
        refused(scarid("convert", log, "-o", tmp_path / "out.csv"), 65, "row 3", found)
        log.write_text(log.read_text().replace(f"\n{wrong},2", f"\n{form.replace('%', '2.25')},2"))


@pytest.mark.parametrize(
    ("line", "header"),
    [
        ("identify --robot scara2 log.csv", "time,position_0,position_1,effort_0,effort_1"),
        ("identify --robot scara2 --from-time 1 log.csv", "t,q0,q1,tau0,tau1"),
        ("differentiate -o motion.csv log.csv", "__time,/a/q1,/a/q2,/a/effort_1,/a/effort_2"),
        ("tune < log.csv", "timestamp,actual_q_0,actual_q_1,a,b"),
        ("check log.csv", "Time (s),Q1,Q2,Tau1,Tau2"),
    ],
)
def test_a_log_with_names_that_convert_knows_is_refused_with_the_pipe_that_renames_it(
    line: str, header: str, shell: Run
) -> None:
    shell(f"(echo '{header}'; tail -n +2 $SAMPLES/scara2.csv | cut -d, -f1-5) > log.csv")
    failed = shell(f"scarid {line}")
    assert failed.status == 65
    assert failed.err.count("\n") == 1
    assert "log with other names of columns" in shell("scarid info log.csv").out
    pipe = failed.err.rpartition("`")[0].partition("; rename them with `")[2]
    renamed = shell(f"cat log.csv | {pipe}")
    assert "columns " in renamed.err
    assert renamed.status == 0, renamed.err


def test_of_several_logs_the_one_with_other_names_is_to_be_converted(shell: Run) -> None:
    shell("sed 's/q2/position_2/; s/q1/position_1/' $SAMPLES/scara2.csv | cut -d, -f1-5 > log.csv")
    failed = shell("scarid identify --robot scara2 log.csv log.csv")
    expected = (
        "`scarid identify --robot scara2 <(scarid convert --robot scara2 --format arrow log.csv)"
    )
    assert f"rename them with {expected} log.csv`" in failed.err


def test_every_recorder_can_be_named() -> None:
    option = next(p for p in convert.command.params if p.name == "recorder")
    assert set(option.type.choices) == {*RECORDERS, *OTHER_NAMES}  # type: ignore[attr-defined]


def test_currents_become_torques_by_the_description_only(scarid: Run, tmp_path: Path) -> None:
    log = tmp_path / "log.csv"
    log.write_text("timestamp,actual_q_0,actual_current_0\n0,1,2\n0.002,1,3\n")
    plain = scarid("convert", log)
    assert plain.out.startswith("t,q1,current1\n0,1,2\n")
    assert "currents stay currents [A]" in plain.err
    robot = tmp_path / "one.toml"
    robot.write_text(
        'title = "one"\n[log]\ntorques = "current"\n'
        '[[joint]]\ntype = "revolute"\ngear_ratio = 50.0\ntorque_constant = 0.1\n'
        '[[parameter]]\nname = "Fv1"\nterm = "viscous"\njoint = 1\n'
        'unit = "N m s/rad"\napriori = 0\n'
    )
    assert scarid("convert", log, "--robot", robot).out == "t,q1,tau1\n0,1,10\n0.002,1,15\n"


@pytest.mark.parametrize(
    ("first", "second", "header"),
    [
        ("observation.state", "action", "q1,q2,q1_ref,q2_ref"),
        ("observation.state.pos", "observation.state.effort", "q1,q2,tau1,tau2"),
    ],
)
def test_episodes_of_lerobot_become_segments(
    first: str, second: str, header: str, scarid: Run, tmp_path: Path
) -> None:
    """Lists become columns; each episode starts a second after the end of the one before."""
    state = [[float(k), -float(k)] for k in range(5)]
    pyarrow.parquet.write_table(
        pa.table(
            {
                first: pa.array(state, pa.list_(pa.float32(), 2)),
                second: pa.array(state, pa.list_(pa.float32())),
                "timestamp": pa.array([0.0, 0.5, 1.0, 0.0, 0.5], pa.float32()),
                "episode_index": pa.array([7, 7, 7, 9, 9], pa.int64()),
            }
        ),
        tmp_path / "episodes.parquet",
        row_group_size=2,
    )
    result = scarid("convert", tmp_path / "episodes.parquet")
    assert result.out.splitlines() == [
        f"{header},t,episode_index,segment",
        "0,-0,0,-0,0,7,0",
        "1,-1,1,-1,0.5,7,0",
        "2,-2,2,-2,1,7,0",
        "3,-3,3,-3,2,9,1",
        "4,-4,4,-4,2.5,9,1",
    ]


def test_quantities_in_files_of_their_own_come_side_by_side(scarid: Run, tmp_path: Path) -> None:
    random = np.random.default_rng(2)
    q, tau = random.normal(size=(2, 20_000, 3))
    np.savetxt(tmp_path / "positions.txt", q, fmt="%.17g")
    np.savetxt(tmp_path / "torques.csv", tau, fmt="%.17g", delimiter=",")
    result = scarid(
        "convert", tmp_path / "positions.txt", "--beside", tmp_path / "torques.csv",
        "--map", "q*=positions,tau*=torques", "--rate", 1000,
    )  # fmt: skip
    assert result.status == 0, result.err
    header, *rows = result.out.splitlines()
    assert header == "t,q1,q2,q3,tau1,tau2,tau3"
    values = np.array([[float(x) for x in row.split(",")] for row in rows])
    np.testing.assert_array_equal(values[:, 1:], np.hstack((q, tau)))
    (tmp_path / "short.csv").write_text("tau1\n1\n")
    (tmp_path / "clock.csv").write_text("t,tau1\n0,1\n2,1\n")
    (tmp_path / "q.csv").write_text("t,q1\n0,1\n1,2\n")
    for name, words in (
        ("short.csv", "found 1 row, fewer than in"),
        ("clock.csv", "row 2, column t: found 2.0, expected 1.0"),
    ):
        failed = scarid("convert", tmp_path / "q.csv", "--beside", tmp_path / name, "-q",
                        "-o", tmp_path / "x.csv")  # fmt: skip
        refused(failed, 65, words)


@pytest.mark.parametrize("extension", ["npz", "mat"])
def test_a_matrix_is_renamed_by_a_pattern(extension: str, scarid: Run, tmp_path: Path) -> None:
    import scipy.io

    arrays = {"time": np.arange(3.0), "positions": np.arange(6.0).reshape(3, 2)}
    path = tmp_path / f"log.{extension}"
    np.savez(path, **arrays) if extension == "npz" else scipy.io.savemat(path, arrays)
    result = scarid("convert", path, "--map", "t=time,q*=positions")
    assert result.out == "t,q1,q2\n0,0,1\n1,2,3\n2,4,5\n"


@pytest.mark.parametrize(
    ("text", "words", "message"),
    [
        ("0,1,2\n1,2,3\n", [], "no header: the first line is a row of 3 numbers; name them: "
         "--header t,q1,tau1, or call them log1, log2, ... and rename them: --map 'q*=log'"),
        ("t;q1\n0,5;1.5\n", [], "decimal commas and decimal points in the same rows; say which"),
        ("t,q1\n0,1\n", ["--from", "libfranka"], "needs the columns time and state.q[0]"),
        ("t,q1\n0,1\n", ["--map", "q*=positions"], "no column positions1; it has t, q1"),
        ("__time,/a/j/position,/b/j/position\n0,1,2\n", [], "both /a/j/position and /b/j/position"),
        ("__time,/a/j/position\n0,1\n", ["--joints", "k"], "no column q of joint k; it has"),
    ],
)  # fmt: skip
def test_what_is_ambiguous_is_refused_with_the_option(
    text: str, words: list[str], message: str, scarid: Run, tmp_path: Path
) -> None:
    (tmp_path / "log.csv").write_text(text)
    refused(scarid("convert", tmp_path / "log.csv", *words), 2, message)


def test_a_broken_gzip_file_is_reported(scarid: Run, tmp_path: Path) -> None:
    data = gzip.compress(b"t,q1\n0,1\n1,2\n")
    (tmp_path / "cut.csv.gz").write_bytes(data[:-9])
    words = ("convert", "-o", tmp_path / "x.csv")
    refused(scarid(*words, tmp_path / "cut.csv.gz"), 65, "cut.csv.gz: a gzip file that was cut")
    (tmp_path / "bad.csv.gz").write_bytes(data[:12] + b"xxxx" + data[16:])
    refused(scarid(*words, tmp_path / "bad.csv.gz"), 65, "bad.csv.gz: a broken gzip file")
