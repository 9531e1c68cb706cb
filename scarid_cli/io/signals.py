"""Signals of joints in the messages of a topic, matched by the names of the joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.arrays import Numbers as Integers
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.bags import Bag, Topic
from scarid_cli.io.cdr import Layout, Numbers, layout

Bytes = np.ndarray[Any, np.dtype[np.uint8]]
Q, TAU = "q{i}", "tau{i}"  # columns of a table, in which {i} is the number of the joint
BLOCK = 8192  # messages that are held at a time
RECENT = 8  # layouts that a message is compared with before it is read field by field


@dataclass(frozen=True)
class Kind:
    """A type of message: the path of the names, and for each column those of its values.

    The first path with values counts. With `points`, each element of this array is a row, paths
    begin there, and its time counts from that of the message. With `each`, this array has an
    element for each joint, with the names of its interfaces and their values, and the paths are
    names of interfaces. Without `names`, joints are joint1, joint2, ...
    """

    names: str
    columns: dict[str, tuple[str, ...]]
    points: str = ""
    each: str = ""


KINDS = {
    "sensor_msgs/msg/JointState": Kind(
        "name", {Q: ("position",), "dq{i}_measured": ("velocity",), TAU: ("effort",)}
    ),
    "control_msgs/msg/JointTrajectoryControllerState": Kind(
        "joint_names",
        {
            Q: ("feedback.positions", "actual.positions"),
            "dq{i}_measured": ("feedback.velocities", "actual.velocities"),
            TAU: ("feedback.effort", "actual.effort", "output.effort"),
            "q{i}_ref": ("reference.positions", "desired.positions"),
            "dq{i}_ref": ("reference.velocities", "desired.velocities"),
            "ddq{i}_ref": ("reference.accelerations", "desired.accelerations"),
        },
    ),
    "control_msgs/msg/DynamicJointState": Kind(
        "joint_names",
        {Q: ("position",), "dq{i}_measured": ("velocity",), TAU: ("effort", "torque")},
        each="interface_values",
    ),
    "franka_msgs/msg/FrankaState": Kind(
        "",
        {
            Q: ("q",),
            "dq{i}_measured": ("dq",),
            TAU: ("tau_j", "tau_J"),
            "q{i}_ref": ("q_d",),
            "dq{i}_ref": ("dq_d",),
        },
    ),
    "franka_msgs/msg/FrankaRobotState": Kind(
        "measured_joint_state.name",
        {
            Q: ("measured_joint_state.position",),
            "dq{i}_measured": ("measured_joint_state.velocity",),
            TAU: ("measured_joint_state.effort",),
            "q{i}_ref": ("desired_joint_state.position",),
            "dq{i}_ref": ("desired_joint_state.velocity",),
        },
    ),
    "trajectory_msgs/msg/JointTrajectory": Kind(
        "joint_names",
        {
            Q: ("positions",),
            "dq{i}": ("velocities",),
            "ddq{i}": ("accelerations",),
            TAU: ("effort",),
        },
        points="points",
    ),
}


@dataclass(frozen=True)
class Series:
    """The rows of a topic: when each message was `stamped` (0 if it was not) and `received` [ns],
    and by column the values (rows, joints), nan where a message has none.

    `skipped` is the number of messages that lack a joint.
    """

    topic: str
    joints: tuple[str, ...]
    stamped: Integers
    received: Integers
    columns: dict[str, Array]
    skipped: int

    @property
    def times(self) -> Integers:
        """The time of each row [ns]: that of its stamp, or of its receipt if any has no stamp."""
        return self.stamped if self.has_stamps else self.received

    @property
    def has_stamps(self) -> bool:
        return bool(np.all(self.stamped > 0))


def series(bag: Bag, topic: Topic, wanted: Sequence[str] = ()) -> Series:
    """The signals of a topic for the wanted joints, by default those of its first message."""
    reading = _Reading(bag, topic, tuple(wanted))
    messages = bag.messages(topic)
    parts = []
    while block := list(islice(messages, BLOCK)):
        parts.append(reading.part([data for _, data in block], [when for when, _ in block]))
    parts = [part for part in parts if len(part.received)]
    if not parts:
        raise _no_rows(reading)
    used = [name for name in reading.kind.columns if any(name in part.columns for part in parts)]
    return Series(
        topic.name,
        reading.wanted,
        np.concatenate([part.stamped for part in parts]),
        np.concatenate([part.received for part in parts]),
        {name: np.concatenate([part.values(name) for part in parts]) for name in used},
        reading.skipped,
    )


def _no_rows(reading: _Reading) -> BadData:
    return bad_data(
        f"{reading.bag.name}, topic {reading.topic.name}",
        f"the joints {', '.join(reading.seen) or '(no names)'}",
        expected=", ".join(reading.wanted) or "names of joints with values",
        remedy="name them with --joints a,b,c, or choose another --topic",
    )


@dataclass
class _Part:
    """Rows of some messages, as in Series."""

    stamped: Integers
    received: Integers
    columns: dict[str, Array]
    joints: int

    def values(self, name: str) -> Array:
        found = self.columns.get(name)
        return np.full((len(self.received), self.joints), np.nan) if found is None else found


Values = tuple[Numbers, ...]  # one piece, or one for each joint


@dataclass(frozen=True)
class _Row:
    """Where the values of a row are, and in which order; `after` are seconds and nanoseconds."""

    columns: dict[str, Values]
    order: tuple[int, ...]
    after: tuple[Numbers, Numbers] | None


@dataclass
class _Group:
    """Messages of the same layout, and their numbers in the block."""

    layout: Layout
    rows: list[_Row]
    messages: list[bytes]
    numbers: list[int]


class _Reading:
    """Reads the messages of a topic; knows the layouts so far."""

    def __init__(self, bag: Bag, topic: Topic, wanted: tuple[str, ...]) -> None:
        self.bag, self.topic, self.wanted = bag, topic, wanted
        self.kind = KINDS[topic.type]
        self.skipped = self.count = 0
        self.seen: dict[str, None] = {}
        self._recent: list[Layout] = []

    def part(self, messages: list[bytes], received: list[int]) -> _Part:
        """The rows of these messages."""
        groups = self._groups(messages)
        rows = np.zeros(len(messages), dtype=np.int64)
        for group in groups:
            rows[group.numbers] = len(group.rows)
        first = np.cumsum(rows) - rows
        total = int(rows.sum())
        part = _Part(np.zeros(total, np.int64), np.zeros(total, np.int64), {}, len(self.wanted))
        part.received[:] = np.repeat(np.array(received, dtype=np.int64), rows)
        for group in groups:
            data = np.frombuffer(b"".join(group.messages), np.uint8)
            _fill(part, group, data.reshape(len(group.messages), -1), first[group.numbers])
        return part

    def _groups(self, messages: list[bytes]) -> list[_Group]:
        groups: dict[int, _Group] = {}
        for number, message in enumerate(messages):
            found = self._layout(message)
            group = groups.get(id(found))
            if group is None:
                group = groups[id(found)] = _Group(found, self._rows(found), [], [])
            group.messages.append(message)
            group.numbers.append(number)
            self.skipped += not group.rows
        self.count += len(messages)
        return [group for group in groups.values() if group.rows]

    def _layout(self, message: bytes) -> Layout:
        """The layout of a message: a recent one if it fits, which is then the most recent."""
        recent = self._recent
        for at, known in enumerate(recent):
            if known.fits(message):
                if at:
                    recent.insert(0, recent.pop(at))
                return known
        try:
            found = layout(message, self.topic.type, self.bag.definitions, cdr=self.bag.cdr)
        except (ValueError, KeyError) as error:
            raise BadData(
                f"{self.bag.name}, topic {self.topic.name}: a message cannot be read ({error}); "
                "record it again"
            ) from None
        recent.insert(0, found)
        del recent[RECENT:]
        return found

    def _rows(self, found: Layout) -> list[_Row]:
        """The rows of a message of this layout; none if it lacks a joint."""
        names = found.texts.get(self.kind.names, []) if self.kind.names else self._numbered(found)
        self.seen |= dict.fromkeys(names)
        starts = list(_starts(found, self.kind))
        columns = [self._columns(found, start, len(names)) for start in starts]
        if not self.wanted and any(Q in own for own in columns):
            self.wanted = tuple(names)
        if not self.wanted or not set(self.wanted) <= set(names):
            return []
        order = tuple(names.index(joint) for joint in self.wanted)
        return [
            _Row(own, order, _after(found, start) if self.kind.points else None)
            for own, start in zip(columns, starts, strict=True)
            if own
        ]

    def _numbered(self, found: Layout) -> list[str]:
        """Names of joints that have none, as many as there are positions."""
        values = found.numbers.get(self.kind.columns[Q][0])
        return [f"joint{i}" for i in range(1, values.count + 1)] if values else []

    def _columns(self, found: Layout, start: str, joints: int) -> dict[str, Values]:
        """The columns that have values; there must be one for each of the names."""
        if self.kind.each:
            return _interfaces(found, self.kind, joints)
        columns: dict[str, Values] = {}
        for name, paths in self.kind.columns.items():
            given = (found.numbers.get(start + path) for path in paths)
            values = next((one for one in given if one and one.count), None)
            if values and values.count != joints:
                raise bad_data(
                    f"{self.bag.name}, topic {self.topic.name}",
                    f"{values.count} values of {name.replace('{i}', '')} for {joints} names",
                    expected="one per name, or none",
                    remedy="correct the publisher, or choose another --topic",
                    row=self.count + 1,
                )
            if values:
                columns[name] = (values,)
        return columns


def _interfaces(found: Layout, kind: Kind, joints: int) -> dict[str, Values]:
    """The columns of which every joint has an interface."""
    columns: dict[str, Values] = {}
    for name, interfaces in kind.columns.items():
        pieces = [_interface(found, f"{kind.each}.{k}", interfaces) for k in range(joints)]
        own = [piece for piece in pieces if piece]
        if own and len(own) == joints:
            columns[name] = tuple(own)
    return columns


def _interface(found: Layout, start: str, interfaces: Sequence[str]) -> Numbers | None:
    """Where the value of the first of these interfaces is that a joint has."""
    names = found.texts.get(f"{start}.interface_names", [])
    values = found.numbers.get(f"{start}.values")
    at = next((names.index(name) for name in interfaces if name in names), None)
    if at is None or values is None or at >= values.count:
        return None
    return Numbers(values.offset + at * int(values.type[-1]), 1, values.type)


def _starts(found: Layout, kind: Kind) -> Iterator[str]:
    """How the paths of each row begin."""
    if not kind.points:
        yield ""
        return
    number = 0
    while f"{kind.points}.{number}.time_from_start.sec" in found.numbers:
        yield f"{kind.points}.{number}."
        number += 1


def _after(found: Layout, start: str) -> tuple[Numbers, Numbers]:
    own = f"{start}time_from_start"
    return found.numbers[f"{own}.sec"], found.numbers[f"{own}.nanosec"]


def _fill(part: _Part, group: _Group, data: Bytes, first: Integers) -> None:
    """Put the values of messages with the same layout, the rows of `data`, where they belong."""
    stamps = [group.layout.numbers.get(f"header.stamp.{name}") for name in ("sec", "nanosec")]
    stamped = _nanoseconds(data, stamps[0], stamps[1]) if stamps[0] and stamps[1] else 0
    for number, row in enumerate(group.rows):
        at = first + number
        after = _nanoseconds(data, *row.after) if row.after else 0
        part.stamped[at] = np.where(np.asarray(stamped) > 0, stamped + after, 0)
        part.received[at] += after
        for name, values in row.columns.items():
            if name not in part.columns:
                part.columns[name] = np.full((len(part.received), part.joints), np.nan)
            pieces = [_view(data, piece) for piece in values]
            part.columns[name][at] = np.concatenate(pieces, axis=1)[:, row.order]


def _nanoseconds(data: Bytes, seconds: Numbers, rest: Numbers) -> Integers:
    whole = _view(data, seconds)[:, 0].astype(np.int64)
    found: Integers = whole * 1_000_000_000 + _view(data, rest)[:, 0].astype(np.int64)
    return found


def _view(data: Bytes, numbers: Numbers) -> Array:
    """These numbers of all messages (messages, count)."""
    size = numbers.count * int(numbers.type[-1])
    own = np.ascontiguousarray(data[:, numbers.offset : numbers.offset + size])
    return own.view(numbers.type)
