"""Recordings for the tests, made by the official MCAP writer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from mcap_ros2.writer import Writer

START = 1_700_000_000 * 10**9  # ns, of a recording
MILLISECOND = 10**6  # ns
HEADER = """std_msgs/Header header
"""
PARTS = """
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
================================================================================
MSG: builtin_interfaces/Duration
int32 sec
uint32 nanosec
================================================================================
MSG: trajectory_msgs/JointTrajectoryPoint
float64[] positions
float64[] velocities
float64[] accelerations
float64[] effort
builtin_interfaces/Duration time_from_start
================================================================================
MSG: control_msgs/InterfaceValue
string[] interface_names
float64[] values
================================================================================
MSG: sensor_msgs/JointState
std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
"""
DEFINITIONS = {
    "sensor_msgs/msg/JointState": "string[] name\nfloat64[] position\nfloat64[] velocity\n"
    "float64[] effort",
    "control_msgs/msg/JointTrajectoryControllerState": "string[] joint_names\n"
    + "\n".join(
        f"trajectory_msgs/JointTrajectoryPoint {part}"
        for part in ("reference", "feedback", "error", "output")
    ),
    "trajectory_msgs/msg/JointTrajectory": "string[] joint_names\n"
    "trajectory_msgs/JointTrajectoryPoint[] points",
    "control_msgs/msg/DynamicJointState": "string[] joint_names\n"
    "control_msgs/InterfaceValue[] interface_values",
    "franka_msgs/msg/FrankaState": "float64[2] q\nfloat64[2] dq\nfloat64[2] tau_j",
    "franka_msgs/msg/FrankaRobotState": "sensor_msgs/JointState measured_joint_state\n"
    "sensor_msgs/JointState desired_joint_state",
    "std_msgs/msg/String": "string data",
}
STATE = "sensor_msgs/msg/JointState"
Message = tuple[str, int, dict[str, Any]]  # topic, time [ns], content


def stamp(ns: int) -> dict[str, int]:
    return {"sec": ns // 10**9, "nanosec": ns % 10**9}


def header(ns: int) -> dict[str, Any]:
    return {"stamp": stamp(ns), "frame_id": ""}


def state(ns: int, names: Sequence[str], **arrays: Sequence[float]) -> dict[str, Any]:
    """A JointState; arrays that are not given are empty."""
    values = {key: list(arrays.get(key, ())) for key in ("position", "velocity", "effort")}
    return {"header": header(ns), "name": list(names), **values}


def write_mcap(
    path: Path, types: dict[str, str], messages: Iterable[Message], chunk: int = 1 << 20
) -> Path:
    """A recording of these topics with their types; messages are received a second later.

    `chunk` is the size in bytes from which messages are compressed together.
    """
    with path.open("wb") as file:
        writer = Writer(file, chunk_size=chunk)
        schemas = {
            topic: writer.register_msgdef(kind, HEADER + DEFINITIONS[kind] + PARTS)
            for topic, kind in types.items()
        }
        for topic, when, content in messages:
            at = when + 10**9
            writer.write_message(topic, schemas[topic], content, log_time=at, publish_time=at)
        writer.finish()
    return path


def table(text: str) -> tuple[list[str], np.ndarray[Any, np.dtype[np.float64]]]:
    """The columns of a CSV and its values (rows, columns)."""
    first, *rows = text.splitlines()
    return first.split(","), np.array([[float(x) for x in row.split(",")] for row in rows])
