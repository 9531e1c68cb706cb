"""Logs as other programs write them end in the table of the same numbers in CSV."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import h5py
import numpy as np
import pytest
from bags import MILLISECOND, START, header, state, table, write_mcap
from conftest import Result, Shell
from hypothesis import given
from hypothesis import strategies as st
from scipy.io import savemat

from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.jsonio import read_json

ROWS = 50
RNG = np.random.default_rng(1)
T = 0.01 * np.arange(ROWS)
Q, TAU = RNG.standard_normal((2, ROWS, 2))
ALL = np.column_stack((T, Q, TAU))
NAMES = ["t", "q1", "q2", "tau1", "tau2"]

Writer = Callable[[Path], str]


def as_objects_of_joints(folder: Path) -> str:
    joints = [
        {"name": f"joint_{k + 1}", "position": Q[:, k].tolist(), "torque": TAU[:, k].tolist()}
        for k in range(2)
    ]
    (folder / "log.json").write_text(json.dumps({"time": T.tolist(), "joints": joints}))
    return "log.json"


def as_nameless_objects(folder: Path) -> str:
    joints = [{"q": Q[:, k].tolist(), "tau": TAU[:, k].tolist()} for k in range(2)]
    document = {"version": 1, "t": T.tolist(), "joint": joints}
    (folder / "log.json").write_text(json.dumps(document))
    return "--map 'q*=joint[*].q' --map 'tau*=joint[*].tau' log.json"


def as_lines(folder: Path) -> str:
    rows = zip(T.tolist(), Q.tolist(), TAU.tolist(), strict=True)
    lines = (json.dumps({"t": t, "q": q, "tau": tau}) for t, q, tau in rows)
    (folder / "log.jsonl").write_text("\n".join(lines) + "\n")
    return "--map 'q*=q[*]' --map 'tau*=tau[*]' log.jsonl"


def nested(folder: Path) -> str:
    rows = zip(T.tolist(), Q.tolist(), TAU.tolist(), strict=True)
    found = [{"t": t, "joints": {"q": q, "tau": tau}} for t, q, tau in rows]
    document = {"meta": {"robot": "x"}, "samples": found}
    (folder / "log.json").write_text(json.dumps(document, indent=1))
    return "--map 'q*=joints.q[*]' --map 'tau*=joints.tau[*]' log.json"


def as_columns(folder: Path) -> str:
    document = {"t": T.tolist(), "q": Q.tolist(), "tau": TAU.tolist()}
    (folder / "log.json").write_text(json.dumps(document))
    return "--map 'q*=q[*]' --map 'tau*=tau[*]' log.json"


def cells(folder: Path) -> str:
    rows = zip(T.tolist(), Q.tolist(), TAU.tolist(), strict=True)
    lines = [f'{t!r},"[{q[0]!r}, {q[1]!r}]","({tau[0]!r} {tau[1]!r})"' for t, q, tau in rows]
    (folder / "log.csv").write_text("t,q,tau\n" + "\n".join(lines) + "\n")
    return "--map 'q*=q[*]' --map 'tau*=tau[*]' log.csv"


def apart(folder: Path) -> str:
    for name, values in (("position", Q), ("effort", TAU)):
        rows = np.column_stack((T, values))
        np.savetxt(folder / f"{name}.csv", rows, "%.17g", ",", header="t,a,b", comments="")
    return "--map q1=a --map q2=b --beside tau=effort.csv position.csv"


def v73(folder: Path) -> str:
    """As MATLAB writes -v7.3: HDF5 behind 512 bytes, matrices transposed."""
    with h5py.File(folder / "log.mat", "w", userblock_size=512) as file:
        for name, values in (("t", T[:, None]), ("q", Q), ("tau", TAU)):
            own = file.create_dataset(name, data=values.T)
            own.attrs["MATLAB_class"] = np.bytes_("double")
    return "log.mat"


def hdf5(folder: Path) -> str:
    with h5py.File(folder / "log.h5", "w") as file:
        file["t"] = T
        file["joints/q"] = Q
        file["joints/tau"] = TAU
    return "--map 'q*=joints.q*' --map 'tau*=joints.tau*' log.h5"


def with_time(folder: Path) -> str:
    """Simulink's "Structure With Time"."""
    signals = np.zeros(2, dtype=[("values", "O"), ("dimensions", "O"), ("label", "O")])
    for k, (values, label) in enumerate(((Q, "q"), (TAU, "tau"))):
        signals[k] = (values, 2.0, label)
    log = {"time": T[:, None], "signals": signals, "blockName": "a/b"}
    savemat(folder / "log.mat", {"log": log})
    return "--map 'q*=log.signals1.values*' --map 'tau*=log.signals2.values*' log.mat"


def pandas(path: Path, write: Callable[[dict[str, list[float]]], Any]) -> str:
    """A file of one of the forms in which pandas writes a frame as JSON."""
    columns = dict(zip(NAMES, ALL.T.tolist(), strict=True))
    (path / "log.json").write_text(json.dumps(write(columns)))
    return "log.json"


def by_column(path: Path) -> str:
    return pandas(
        path, lambda x: {name: {str(k): v for k, v in enumerate(own)} for name, own in x.items()}
    )


def by_row(path: Path) -> str:
    rows = [dict(zip(NAMES, own, strict=True)) for own in ALL.tolist()]
    return pandas(path, lambda _: {str(k): row for k, row in enumerate(rows)})


def split(path: Path) -> str:
    return pandas(path, lambda x: {"columns": [*x], "index": [], "data": ALL.tolist()})


def with_schema(path: Path) -> str:
    rows = [dict(zip(NAMES, own, strict=True)) for own in ALL.tolist()]
    fields = [{"name": name, "type": "number"} for name in NAMES]
    return pandas(path, lambda _: {"schema": {"fields": fields}, "data": rows})


def beside_facts(path: Path) -> str:
    """Columns in objects of their own, beside single values."""
    file = pandas(path, lambda x: {"rate": 100, "log": x})
    return f"--map t=log.t --map 'q*=log.q' --map 'tau*=log.tau' {file}"


def row_for_each_joint(path: Path) -> str:
    file = pandas(path, lambda x: {"t": x["t"], "q": Q.T.tolist(), "tau": TAU.T.tolist()})
    return f"--map 'q*=q[*]' --map 'tau*=tau[*]' {file}"


KINDS = [
    as_objects_of_joints,
    as_nameless_objects,
    as_lines,
    nested,
    as_columns,
    cells,
    apart,
    v73,
    hdf5,
    with_time,
    by_column,
    by_row,
    split,
    with_schema,
    beside_facts,
    row_for_each_joint,
]


@pytest.mark.parametrize("write", KINDS)
def test_the_table_is_that_of_the_numbers(write: Writer, shell: Shell, tmp_path: Path) -> None:
    done = shell(f"scarid convert {write(tmp_path)}")
    assert done.status == 0, done.err
    names, values = table(done.out)
    order = [names.index(name) for name in NAMES]
    np.testing.assert_array_equal(values[:, order], ALL)


SMALL = st.floats(allow_nan=False, allow_infinity=False, width=32)


@given(st.lists(st.tuples(SMALL, st.lists(SMALL, min_size=2, max_size=2)), min_size=1))
def test_lines_of_json_come_back(rows: list[tuple[float, list[float]]]) -> None:
    text = "\n".join(json.dumps({"t": t, "a": {"q": q}}) for t, q in rows)
    with TemporaryDirectory() as folder:
        path = Path(folder, "log")
        path.write_text(text)
        found = read_json(ByteSource.open(str(path)))
        assert found.columns == ["t", "a.q[0]", "a.q[1]"]
        values = [list(row.values()) for batch in found.batches for row in batch.to_pylist()]
    assert values == [[t, *q] for t, q in rows]


@pytest.mark.parametrize("motors", [2, 29])
def test_lines_of_a_robot_with_many_motors_are_lines(
    motors: int, shell: Shell, tmp_path: Path
) -> None:
    """As of a humanoid: neither its arrays nor its list of objects are the rows of a document."""
    each = range(motors)
    rows = [{"a": [k + i for i in each], "s": [{"b": k - i} for i in each]} for k in range(3)]
    (tmp_path / "log.jsonl").write_text("\n".join(json.dumps(row) for row in rows))
    done = shell("scarid convert --rate 100 log.jsonl")
    assert done.status == 0, done.err
    names, values = table(done.out)
    assert names == ["t", *(f"a[{i}]" for i in each), *(f"s[{i}].b" for i in each)]
    expected = [[k + i for i in each] + [k - i for i in each] for k in range(3)]
    np.testing.assert_array_equal(values[:, 1:], expected)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('{"t": 0}\n{"t": 1, "q": 2}\n', "row 2: found the key q, which the first row lacks"),
        ('{"t": 0}\n{"t": "x"}\n', "row 2, column t: found 'x', expected a number"),
        ('{"t": 0}\nnonsense\n', "row 2: found 'nonsense', expected an object of JSON"),
        ('[{"t": 0}, {"t"', "not JSON"),
        ('{"a": 1, "b": {"c": 2}', "not JSON"),
        ('{\n"a": "text"\n}', "but no rows"),
        (json.dumps([{"a": [0.0] * 20_000}]), "more than 10,000 values in the first row"),
    ],
)
def test_json_that_is_no_table_is_told(text: str, told: str, shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "log.json").write_text(text)
    done = shell("scarid convert log.json")
    assert done.status == 65
    assert told in done.err


def test_a_list_that_is_cut_is_told(shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text('t,q\n0,"[1, 2]"\n1,"[1, "\n')
    done = shell("scarid convert log.csv")
    assert done.status == 65
    assert "column q: found '[1, ', expected a list of numbers" in done.err


JOINTS = ("a", "b")


def dynamic(k: int, when: int) -> dict[str, Any]:
    """Interfaces in another order at each joint."""
    names = (("position", "velocity", "effort"), ("effort", "temperature", "position"))
    values = ((Q[k, 0], 0.0, TAU[k, 0]), (TAU[k, 1], 30.0, Q[k, 1]))
    own = [
        {"interface_names": list(n), "values": [float(x) for x in v]}
        for n, v in zip(names, values, strict=True)
    ]
    return {"header": header(when), "joint_names": list(JOINTS), "interface_values": own}


def franka(k: int, when: int) -> dict[str, Any]:
    return {"header": header(when), "q": Q[k].tolist(), "dq": [0.0, 0.0], "tau_j": TAU[k].tolist()}


def franka_2(k: int, when: int) -> dict[str, Any]:
    measured = state(when, JOINTS, position=Q[k].tolist(), effort=TAU[k].tolist())
    wanted = state(when, JOINTS, position=[0.0, 0.0])
    return {
        "header": header(when),
        "measured_joint_state": measured,
        "desired_joint_state": wanted,
    }


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("control_msgs/msg/DynamicJointState", dynamic),
        ("franka_msgs/msg/FrankaState", franka),
        ("franka_msgs/msg/FrankaRobotState", franka_2),
    ],
)
def test_messages_of_other_types(
    kind: str, message: Callable[[int, int], dict[str, Any]], shell: Shell, tmp_path: Path
) -> None:
    times = [START + 10 * MILLISECOND * k for k in range(ROWS)]
    messages = [("/s", when, message(k, when)) for k, when in enumerate(times)]
    write_mcap(tmp_path / "log.mcap", {"/s": kind}, messages)
    done = shell("scarid convert log.mcap")
    same(done)
    (tmp_path / "bag").mkdir()
    shutil.move(tmp_path / "log.mcap", tmp_path / "bag" / "log_0.mcap")
    same(shell("scarid convert bag"))


def same(done: Result) -> None:
    assert done.status == 0, done.err
    names, values = table(done.out)
    order = [names.index(name) for name in NAMES]
    np.testing.assert_allclose(values[:, order], ALL, rtol=0, atol=1e-12)
