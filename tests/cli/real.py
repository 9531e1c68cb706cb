"""What the tests with real logs share: descriptions, published values, and a reader of a bag."""

from __future__ import annotations

import contextlib
import csv
import sqlite3
import struct
from pathlib import Path

import pytest
from parts import TX40

TRAIN = ("143524", "143601", "154220")  # logs of the pendulum


def described_six_axes(real_logs: Path, place: Path) -> Path:
    """The folder of the log, with a description of the robot in this place."""
    pytest.importorskip("pinocchio")
    (place / "tx40.toml").write_text(TX40)
    return real_logs / "staubli_tx40"


def one_after_the_other(identify: str) -> str:
    """Commands that identify the logs TRAIN, each going on where the one before ended, to p.csv."""
    first, second, third = TRAIN
    return (
        f"{identify} --save s.npz {first}.csv > /dev/null &&"
        f" {identify} --from s.npz --save s.npz {second}.csv > /dev/null &&"
        f" {identify} --from s.npz {third}.csv -o p.csv"
    )


def far_from_published(table: str, folder: Path) -> set[str]:
    """Base parameters that are more than two published deviations off."""
    estimates = {
        row["parameter"]: float(row["estimate"]) for row in csv.DictReader(table.split("\n"))
    }
    with (folder / "TX40_bp_5.csv").open() as file:
        published = {row[0].split()[0]: (float(row[3]), float(row[4])) for row in csv.reader(file)}
    assert estimates.keys() == published.keys()
    assert len(published) == 60
    return {n for n, (x, r) in published.items() if abs(estimates[n] - x) > 0.02 * r * abs(x)}


def ur10_log(bag: Path, order: list[str], place: Path) -> None:
    """The joint states (ROS 2, CDR) of a bag as a CSV log, with the joints in this order."""
    joints = [f"{name}{i}" for name in ("q", "tau") for i in range(1, len(order) + 1)]
    lines = [",".join(["t", *joints])]
    with contextlib.closing(sqlite3.connect(bag)) as database:
        for (message,) in database.execute("select data from messages order by timestamp"):
            stamp, names, (q, _, effort) = joint_state(message)
            at = [names.index(name) for name in order]
            values = [*(q[k] for k in at), *(effort[k] for k in at)]
            lines.append(",".join(map(repr, [stamp, *values])))
    place.write_text("\n".join(lines) + "\n")


def joint_state(message: bytes) -> tuple[float, list[str], list[tuple[float, ...]]]:
    """Time, names, and positions, velocities and efforts of a sensor_msgs/JointState."""
    place = 4
    seconds, nanoseconds = struct.unpack_from("<iI", message, place)
    place += 8

    def count() -> int:
        nonlocal place
        place += -(place - 4) % 4
        place += 4
        return int(struct.unpack_from("<I", message, place - 4)[0])

    size = count()  # of the name of the frame
    place += size
    names = []
    for _ in range(count()):
        size = count()
        names.append(message[place : place + size - 1].decode())
        place += size
    values = []
    for _ in range(3):
        size = count()
        place += -(place - 4) % 8
        values.append(struct.unpack_from(f"<{size}d", message, place))
        place += 8 * size
    return seconds + 1e-9 * nanoseconds, names, values
