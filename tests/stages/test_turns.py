"""Rows of one joint each become rows of all joints, and names in cells tell the order of arrays."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from conftest import Shell
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.errors import BadData
from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.conversion.cells import in_their_order, names_in_cells
from scarid_cli.stages.conversion.turns import one_row_for_all

JOINTS = ["elbow", "shoulder", "wrist"]


def table_of(columns: dict[str, pa.Array], sizes: list[int]) -> Table:
    """A table of these columns, in batches of these sizes."""
    whole = pa.RecordBatch.from_arrays([*columns.values()], list(columns))
    edges = np.unique(np.clip(np.cumsum([0, *sizes, whole.num_rows]), 0, whole.num_rows))
    batches = [whole.slice(a, b - a) for a, b in pairwise(edges.tolist())]
    return Table("log", whole.schema, Metadata(), iter(batches))


def in_turn(
    joints: list[str] | list[int], turns: int, missing: set[int], sizes: list[int]
) -> tuple[Table, np.ndarray]:
    """Joints that answer 1 ms after one another, some answers missing, and the whole turns."""
    count = len(joints)
    kept = np.array([i for i in range(turns * count) if i not in missing])
    t = 0.01 * (kept // count) + 0.001 * (kept % count)
    position = np.sin(kept)
    columns = {
        "time": pa.array(t),
        "joint": pa.array([joints[i % count] for i in kept]),
        "position": pa.array(position),
    }
    lacking = {i // count for i in missing}
    whole = [k for k in range(turns) if k not in lacking]
    expected = [[0.01 * k, *np.sin(k * count + np.arange(count))] for k in whole]
    return table_of(columns, sizes), np.array(expected)


@given(
    st.permutations(JOINTS),
    st.integers(8, 60),
    st.sets(st.integers(6, 170), max_size=4),
    st.lists(st.integers(1, 50), max_size=8),
)
def test_joints_in_turn_become_arrays(
    joints: list[str], turns: int, missing: set[int], sizes: list[int]
) -> None:
    """However the rows arrive; a turn that lacks a joint is left out, and told."""
    missing = {i for i in missing if i < 3 * turns}
    table, expected = in_turn(joints, turns, missing, sizes)
    said: list[str] = []
    found, names = one_row_for_all(table, said.append)
    assert names == tuple(joints)
    assert found.columns == ["time", "position[0]", "position[1]", "position[2]"]
    rows = pa.Table.from_batches(found.batches, found.schema)
    np.testing.assert_array_equal(np.column_stack([c.to_numpy() for c in rows.columns]), expected)
    assert said[0].endswith("with the time of the first; the last comes 0.002 later")
    parts = any(0 < len(missing & {3 * k, 3 * k + 1, 3 * k + 2}) < 3 for k in range(turns))
    assert [text.rpartition(":")[0] for text in said[1:]] == (
        ["turns left out, as they lack a joint"] if parts else []
    )


def test_joints_with_numbers_are_in_the_order_of_these() -> None:
    table, expected = in_turn([7, 3, 5], 10, set(), [])
    found, names = one_row_for_all(table, lambda _: None)
    rows = pa.Table.from_batches(found.batches, found.schema)
    assert names == ()
    order = [0, 2, 3, 1]  # the time, then 3, 5, 7
    values = np.column_stack([c.to_numpy() for c in rows.columns])
    np.testing.assert_array_equal(values, expected[:, order])


def test_a_joint_that_had_no_turn_is_refused_with_its_row() -> None:
    names = ["a", "b"] * 100
    names[150] = "c"
    columns = {"time": pa.array(np.arange(200.0)), "joint": pa.array(names)}
    columns["position"] = pa.array(np.zeros(200))
    found, _ = one_row_for_all(table_of(columns, []), lambda _: None)
    with pytest.raises(BadData, match="row 151, column joint: found 'c', expected one of a, b"):
        list(found.batches)


@pytest.mark.parametrize(
    "columns",
    [
        {"time": [0.0, 1.0], "joint": ["a", "a"], "position": [1.0, 2.0]},
        {"time": [0.0] * 4, "mode": ["a", "b", "a", "b"], "position": [1.0] * 4},
        {"time": [0.0] * 4, "id": [1, 2, 1, 2], "position_1": [1.0] * 4},
        {"time": [0.0] * 4, "id": [1, 2, 3, 4], "position": [1.0] * 4},
        {"time": [], "joint": [], "position": []},
    ],
)
def test_other_tables_stay_as_they_are(columns: dict[str, list[float]]) -> None:
    arrays = {name: pa.array(own) for name, own in columns.items()}
    found, names = one_row_for_all(table_of(arrays, []), pytest.fail)
    assert names == ()
    assert pa.Table.from_batches(found.batches, found.schema).to_pydict() == columns


@given(names=st.permutations([*JOINTS, "gripper"]), listed=st.booleans())
def test_names_in_cells_put_arrays_in_order(*, names: list[str], listed: bool) -> None:
    """In the order of the robot's joints, whatever that of the log; others are left out."""
    rows = 3
    columns = (
        {"name": pa.array([str(names)] * rows)}
        if listed
        else {f"js.name{k}": pa.array([name] * rows) for k, name in enumerate(names)}
    )
    table, found = names_in_cells(table_of(columns, []))
    assert found == tuple(names)
    assert sum(batch.num_rows for batch in table.batches) == rows
    arrays = {f"q{k + 1}": f"position[{k}]" for k in range(4)}
    arrays |= {f"tau{k + 1}": f"effort[{k}]" for k in range(4)} | {"t": "time"}
    ordered = in_their_order(arrays, found, JOINTS)
    assert ordered == {
        **{f"q{i + 1}": f"position[{names.index(joint)}]" for i, joint in enumerate(JOINTS)},
        **{f"tau{i + 1}": f"effort[{names.index(joint)}]" for i, joint in enumerate(JOINTS)},
        "t": "time",
    }
    assert in_their_order(arrays, found, ["other"]) == arrays


def test_names_that_change_are_refused_with_their_row() -> None:
    names = pa.array(["[a, b]", "[a, b]", "[b, a]"])
    table, _ = names_in_cells(table_of({"name": names}, [1]))
    with pytest.raises(BadData, match="row 3, column name: found '\\[b, a\\]'"):
        list(table.batches)


@pytest.mark.parametrize("options", ["", "--map 't=time,q*=angle*_deg,tau*=load* [mN m]'"])
def test_joints_in_turn_are_in_the_order_of_the_robot(
    options: str, shell: Shell, tmp_path: Path
) -> None:
    """With units in the names of the columns, and whether these are mapped or recognised."""
    rows = [
        f"{0.01 * k:g},{name},{180.0 * (k + place)},{1000.0 * place}"
        for k in range(9)
        for name, place in (("elbow", 2), ("base", 1))
    ]
    names = "time,joint,angle_deg," + ("load [mN m]" if options else "torque [mN m]")
    (tmp_path / "log.csv").write_text("\n".join([names, *rows]) + "\n")
    done = shell(f"scarid convert --joints base,elbow {options} log.csv")
    assert done.status == 0, done.err
    header, first, *_ = done.out.splitlines()
    found = dict(zip(header.split(","), map(float, first.split(",")), strict=True))
    assert found == pytest.approx(
        {"t": 0.0, "q1": np.pi, "q2": 2.0 * np.pi, "tau1": 1.0, "tau2": 2.0}
    )
    assert "put in the order base, elbow: the log has elbow, base" in done.err


def test_joints_that_the_robot_does_not_name_keep_their_places_and_are_told(
    shell: Shell, tmp_path: Path
) -> None:
    rows = [
        f'{{"time": {0.01 * k:g}, "name": ["a", "b"], "position": [{k}, 1], "effort": [1, {k}]}}'
        for k in range(9)
    ]
    (tmp_path / "log.jsonl").write_text("\n".join(rows) + "\n")
    done = shell("scarid convert --joints base,b log.jsonl")
    assert done.status == 0, done.err
    assert (
        "joints as the log names them: a, b (another order: --joints); as none is base" in done.err
    )
