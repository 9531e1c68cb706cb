"""Recordings of ROS, turned into tables."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bags
import numpy as np
import pytest
from bags import MILLISECOND, START, STATE, header, stamp, state, table, write_mcap
from conftest import Result, refused
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

Run = Callable[..., Result]
NAMES = ["shoulder", "elbow_joint", "wrist"]


def signals(t: np.ndarray[Any, Any]) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Positions and efforts of the three joints (3, rows)."""
    k = np.arange(1.0, 4.0)[:, None]
    return np.sin(k * t), k * np.cos(3.0 * t)


def recording(path: Path, rows: int, order: Callable[[int], Any]) -> Path:
    """A MCAP at 1000 Hz whose joints are, in each message, in this order."""
    q, tau = signals(np.arange(rows) * 1e-3)

    def messages() -> Any:
        for k in range(rows):
            when, own = START + k * MILLISECOND, order(k)
            names = [NAMES[i] for i in own]
            yield "/joint_states", when, state(when, names, position=q[own, k], effort=tau[own, k])

    return write_mcap(path, {"/joint_states": STATE}, messages())


def test_joints_are_matched_by_name_in_every_message(scarid: Run, tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    shuffled = recording(tmp_path / "a.mcap", 300, lambda _: random.permutation(3))
    result = scarid("convert", shuffled, "--joints", "wrist,shoulder,elbow_joint")
    columns, values = table(result.out)
    assert columns == ["t", "q1", "q2", "q3", "tau1", "tau2", "tau3"]
    t = np.arange(300) * 1e-3
    q, tau = signals(t)
    mine = [2, 0, 1]
    np.testing.assert_allclose(values.T, [t, *q[mine], *tau[mine]], atol=1e-12)
    ordered = recording(tmp_path / "b.mcap", 300, lambda _: mine)
    assert scarid("convert", ordered).out == result.out


def test_only_the_wanted_joints_are_read_and_the_rest_is_told(scarid: Run, tmp_path: Path) -> None:
    """A gripper that publishes on the same topic, and messages without names."""
    messages = []
    for k in range(10):
        when = START + k * MILLISECOND
        messages.append(("/s", when, state(when, ["a", "finger"], position=[k, 9.0])))
        messages.append(("/s", when, state(when, ["finger"], position=[7.0])))
    messages.append(("/s", when, state(when, [])))
    path = write_mcap(tmp_path / "x.mcap", {"/s": STATE}, messages)
    result = scarid("convert", path, "--joints", "a")
    columns, values = table(result.out)
    assert columns == ["t", "q1"]
    np.testing.assert_array_equal(values[:, 1], np.arange(10.0))
    assert "11 messages of /s left out: they do not have all of the joints a" in result.err
    refused(scarid("convert", path, "--joints", "a,b", "-q"), 65, "a, finger, expected a, b")


def controller_state(when: int) -> dict[str, Any]:
    k = (when - START) / MILLISECOND
    point = {key: [] for key in ("positions", "velocities", "accelerations", "effort")}
    point = {**point, "time_from_start": stamp(0)}
    return {
        "header": header(when), "joint_names": ["a", "b"],
        "reference": {**point, "positions": [k, k], "velocities": [2 * k, 0.0]},
        "feedback": {**point, "positions": [k, -k], "velocities": [3 * k, 1.0]},
        "error": point, "output": {**point, "effort": [5 * k, 4.0]},
    }  # fmt: skip


def test_the_state_of_a_controller_has_references_too(scarid: Run, tmp_path: Path) -> None:
    kind = "control_msgs/msg/JointTrajectoryControllerState"
    times = [START + k * MILLISECOND for k in range(5)]
    path = write_mcap(
        tmp_path / "x.mcap",
        {"/controller/state": kind, "/chatter": "std_msgs/msg/String"},
        [("/controller/state", t, controller_state(t)) for t in times],
    )
    columns, values = table(scarid("convert", path, "--joints", "b,a").out)
    assert columns == [
        "t", "q1", "q2", "dq1_measured", "dq2_measured", "tau1", "tau2",
        "q1_ref", "q2_ref", "dq1_ref", "dq2_ref",
    ]  # fmt: skip
    k = 4.0
    np.testing.assert_allclose(values[4], [4e-3, -k, k, 1, 3 * k, 4, 5 * k, k, k, 0, 2 * k])


def test_a_trajectory_has_a_row_per_point(scarid: Run, tmp_path: Path) -> None:
    points = [
        {
            "positions": [float(k)], "velocities": [1.0], "accelerations": [0.5], "effort": [2.0],
            "time_from_start": stamp(k * 4 * MILLISECOND),
        }
        for k in range(4)
    ]  # fmt: skip
    content = {"header": header(0), "joint_names": ["a"], "points": points}
    path = write_mcap(
        tmp_path / "x.mcap",
        {"/t": "trajectory_msgs/msg/JointTrajectory"},
        [("/t", START, content)],
    )
    result = scarid("convert", path)
    assert result.out == (
        "t,q1,dq1,ddq1,tau1\n0,0,1,0.5,2\n0.004,1,1,0.5,2\n0.008,2,1,0.5,2\n0.012,3,1,0.5,2\n"
    )
    assert "the clock is that of the recorder" in result.err


def joint_state(store: Any, when: int, names: list[str], x: float) -> Any:
    types = store.types
    time = types["builtin_interfaces/msg/Time"](when // 10**9, when % 10**9)
    more = {"seq": 0} if "seq" in types["std_msgs/msg/Header"].__annotations__ else {}
    head = types["std_msgs/msg/Header"](stamp=time, frame_id="base", **more)
    values = x + np.arange(len(names), dtype=float)
    return types[STATE](head, names, values, 10.0 * values, 100.0 * values)


@pytest.mark.parametrize("kind", ["db3", "mcap", "bag", "folder", "renamed", "pipe"])
def test_every_kind_of_recording_gives_the_same(kind: str, shell: Run, tmp_path: Path) -> None:
    store = get_typestore(Stores.ROS1_NOETIC if kind == "bag" else Stores.ROS2_HUMBLE)
    plugin = StoragePlugin.MCAP if kind == "mcap" else StoragePlugin.SQLITE3
    file = tmp_path / "rec"
    writer: Any = (
        Writer1(file) if kind == "bag" else Writer2(file, version=9, storage_plugin=plugin)
    )
    with writer:
        topic = writer.add_connection("/joint_states", STATE, typestore=store)
        for k in range(3):
            when = START + k * MILLISECOND
            names = ["ab", "b"] if k != 1 else ["b", "ab"]
            message = joint_state(store, when, names, k)
            data = (store.serialize_ros1 if kind == "bag" else store.serialize_cdr)(message, STATE)
            writer.write(topic, when, data)
    inside = next(file.glob("rec*.*")) if file.is_dir() else file
    command = f"scarid convert {file if kind == 'folder' else inside}"
    if kind == "renamed":
        inside.rename(tmp_path / "data.bin")
        command = "scarid convert data.bin"
    if kind == "pipe":
        command = f"cat {inside} | scarid convert"
    result = shell(command)
    assert result.status == 0, result.err
    assert result.out == (
        "t,q1,q2,dq1_measured,dq2_measured,tau1,tau2\n"
        "0,0,1,0,10,0,100\n"
        "0.001,2,1,20,10,200,100\n"
        "0.002,2,3,20,30,200,300\n"
    )


def test_a_minute_of_seven_joints_is_read_in_time(scarid: Run, tmp_path: Path) -> None:
    """60,000 messages in 4 s of the processor; another decoder finds the same in the last."""
    from time import process_time

    from mcap.writer import Writer

    store = get_typestore(Stores.ROS2_HUMBLE)
    names = [f"joint_{i}" for i in range(1, 8)]
    data = bytearray(store.serialize_cdr(joint_state(store, START, names, 0.0), STATE))
    path = tmp_path / "minute.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="ros2")
        text = bags.HEADER + bags.DEFINITIONS[STATE] + bags.PARTS
        schema = writer.register_schema(STATE, "ros2msg", text.encode())
        channel = writer.register_channel("/joint_states", "cdr", schema)
        for k in range(60_000):
            when = START + k * MILLISECOND
            data[4:12] = np.array([when // 10**9, when % 10**9], np.uint32).tobytes()
            data[-8:] = np.float64(k).tobytes()
            writer.add_message(channel, when, bytes(data), when)
        writer.finish()
    before = process_time()
    result = scarid("convert", path, "-o", tmp_path / "minute.parquet")
    assert process_time() - before < 4.0
    assert result.status == 0
    import pyarrow.parquet

    found = pyarrow.parquet.read_table(tmp_path / "minute.parquet")
    np.testing.assert_array_equal(found["tau7"].to_numpy(), np.arange(60_000.0))
    np.testing.assert_allclose(found["t"].to_numpy(), np.arange(60_000) * 1e-3, atol=1e-9)
    assert store.deserialize_cdr(bytes(data), STATE).effort[6] == 59_999.0  # type: ignore[attr-defined]


def test_info_lists_the_topics(scarid: Run, tmp_path: Path) -> None:
    path = recording(tmp_path / "x.mcap", 101, lambda _: [0, 1, 2])
    out = scarid("info", path).out
    assert out.splitlines()[1:] == [
        "topics",
        "  /joint_states  sensor_msgs/msg/JointState  101 messages, 1000 Hz",
    ]


def test_what_is_ambiguous_or_broken_is_refused(scarid: Run, tmp_path: Path) -> None:
    two = write_mcap(
        tmp_path / "two.mcap",
        {"/a": STATE, "/b": STATE},
        [(topic, START, state(START, ["j"], position=[0.0])) for topic in ("/a", "/b")],
    )
    refused(
        scarid("convert", two), 2, "several topics with positions", "/b (sensor_msgs", "--topic"
    )
    refused(scarid("convert", two, "--topic", "/c"), 2, "no topic /c; it has /a")
    refused(
        scarid("convert", two, "--topic", "/a", "--robot", "scara2"), 2, "scara2 has 2 joints",
        "--joints",
    )  # fmt: skip
    none = write_mcap(
        tmp_path / "none.mcap", {"/c": "std_msgs/msg/String"},
        [("/c", START, {"header": header(START), "data": "x"})],
    )  # fmt: skip
    refused(scarid("convert", none), 2, "no topic with positions of joints: /c (std_msgs/msg")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(two.read_bytes()[:100])
    refused(scarid("convert", cut), 2, "cut.mcap: no topic with positions of joints: none")


def test_a_recording_without_an_end_is_read_up_to_there(scarid: Run, tmp_path: Path) -> None:
    """Whatever is missing, the rows are the first ones of the whole, and it is said."""
    names = ("a", "b")
    messages = [
        ("/a", START + k * MILLISECOND, state(START + k * MILLISECOND, names, position=[k, -k]))
        for k in range(300)
    ]
    whole = write_mcap(tmp_path / "whole.mcap", {"/a": STATE}, messages, chunk=4000)
    rows = scarid("convert", whole).out.splitlines()
    data = whole.read_bytes()
    counts = []
    for size in range(1000, len(data), 1500):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(data[:size])
        found = scarid("convert", cut)
        if found.status == 0:
            assert "cut.mcap has no end" in found.err
            own = found.out.splitlines()
            assert own == rows[: len(own)]
            counts.append(len(own))
    assert counts == sorted(counts)
    assert len(set(counts)) > 3


def test_a_missing_package_names_the_extra(
    scarid: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = recording(tmp_path / "x.mcap", 2, lambda _: [0, 1, 2])
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    refused(scarid("convert", path), 2, "pip install 'scarid[logs]'")


def test_a_ur10_is_identified_from_its_bag_in_one_line(shell: Run, real_logs: Path) -> None:
    robot, bag = real_logs / "urdf/ur10.urdf", real_logs / "ur10_ros2/ur10_exciting_trajectory.db3"
    result = shell(
        f"scarid convert {bag} --robot {robot} --format arrow |"
        " scarid resample --rate 125 --format arrow | scarid differentiate -o motion.parquet &&"
        f" scarid identify --robot {robot} motion.parquet -o parameters.parquet &&"
        f" scarid validate --robot {robot} --parameters parameters.parquet motion.parquet"
    )
    assert result.status == 0, result.err
    r2 = [float(row.split(",")[1]) for row in result.out.splitlines()[1:]]
    assert len(r2) == 6
    assert min(r2) >= 0.98


@pytest.mark.parametrize("stated", [2, 4, 99])
def test_a_folder_that_states_other_messages_than_it_has_is_refused(
    stated: int, shell: Run, tmp_path: Path
) -> None:
    store, file = get_typestore(Stores.ROS2_HUMBLE), tmp_path / "rec"
    with Writer2(file, version=9, storage_plugin=StoragePlugin.SQLITE3) as writer:
        topic = writer.add_connection("/joint_states", STATE, typestore=store)
        for k in range(3):
            when = START + k * MILLISECOND
            message = joint_state(store, when, ["a"], k)
            writer.write(topic, when, store.serialize_cdr(message, STATE))
    facts = file / "metadata.yaml"
    text = facts.read_text()
    assert "message_count: 3" in text
    facts.write_text(text.replace("message_count: 3", f"message_count: {stated}"))
    found = shell("scarid convert rec -o log.parquet")
    assert (found.status, (tmp_path / "log.parquet").exists()) == (65, False)
    assert f"3 messages of /joint_states, where the recording states {stated}" in found.err
