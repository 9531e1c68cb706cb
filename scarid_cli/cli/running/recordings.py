"""Recordings of ROS as `convert` and `info` take them: which topic, which joints, what is told."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.cli.running.job import Job
from scarid_cli.errors import UsageFault
from scarid_cli.io.bags import Bag, Topic, open_bag
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.signals import KINDS, Series, series
from scarid_cli.io.table import Table
from scarid_cli.stages.conversion.recorded import recorded


@dataclass(frozen=True)
class Choice:
    """What the command line says about a recording; `joints` are their names in order."""

    topic: str | None = None
    torque_topic: str | None = None
    join: str = "linear"
    joints: tuple[str, ...] = ()


def read_recording(
    job: Job, file: str, source: ByteSource, extension: str, choice: Choice, robot: Robot | None
) -> Table:
    """The table of a recording; reports which topic and joints it holds."""
    wanted = choice.joints or (tuple(robot.body.joint_names) if robot and robot.body else ())
    with open_bag(file, source, extension) as bag:
        topic = _topic(bag, choice.topic, choice.torque_topic)
        main = series(bag, topic, wanted)
        other = None
        if choice.torque_topic:
            other = series(bag, _named(bag, choice.torque_topic), main.joints)
    if robot and len(robot.joints) != len(main.joints):
        raise UsageFault(
            f"{robot.name} has {len(robot.joints)} joints, but {topic.name} has "
            f"{', '.join(main.joints)}; name those of the robot in order with --joints"
        )
    if bag.cut:
        job.notes.append(
            f"warning: {source.name} has no end, as of a recorder that was killed; read up to there"
        )
    _say(job, main, topic, given=bool(wanted))
    table, notes = recorded(source.name, main, other, choice.join)
    job.notes += notes
    return table


def _topic(bag: Bag, name: str | None, torques: str | None) -> Topic:
    """The topic of this name, by default the only one with positions of joints."""
    if name:
        return _named(bag, name)
    fitting = [topic for topic in bag.topics if topic.type in KINDS and topic.name != torques]
    if not fitting and torques:
        return _named(bag, torques)
    if len(fitting) != 1:
        what = "several topics" if fitting else "no topic"
        raise UsageFault(
            f"{bag.name}: {what} with positions of joints: {_listed(fitting or bag.topics)}; "
            + ("choose one with --topic" if fitting else f"scarid reads {', '.join(KINDS)}")
        )
    return fitting[0]


def _named(bag: Bag, name: str) -> Topic:
    found = next((topic for topic in bag.topics if topic.name == name), None)
    if found is None:
        raise UsageFault(f"{bag.name}: no topic {name}; it has {_listed(bag.topics)}")
    if found.type not in KINDS:
        raise UsageFault(
            f"{bag.name}: topic {name} has messages of the type {found.type}; scarid reads "
            f"{', '.join(KINDS)}"
        )
    return found


def _listed(topics: Sequence[Topic]) -> str:
    return ", ".join(f"{topic.name} ({topic.type})" for topic in topics) or "none"


def _say(job: Job, main: Series, topic: Topic, *, given: bool) -> None:
    joints = ", ".join(main.joints)
    order = (
        f"joints {joints}"
        if given
        else (f"joints in the order of the first message: {joints} (another: --robot or --joints)")
    )
    job.notes.append(f"{topic.name} ({topic.type}), {_messages(topic.messages)}, {order}")


def _messages(count: int) -> str:
    return f"{count:,} message{'s' if count != 1 else ''}"


def topic_lines(file: str, source: ByteSource, extension: str) -> Iterator[str]:
    """The lines that describe a recording: its topics, with their types, counts and rates."""
    with open_bag(file, source, extension) as bag:
        yield f"recording {bag.name}"
        yield "topics"
        width = max((len(topic.name) for topic in bag.topics), default=0)
        for topic in bag.topics:
            times = [when for when, _ in bag.messages(topic)]
            span = 1e-9 * (times[-1] - times[0]) if times else 0.0
            rate = f", {(len(times) - 1) / span:.6g} Hz" if span > 0.0 else ""
            mark = "" if topic.type in KINDS else "  (not read)"
            yield f"  {topic.name:<{width}}  {topic.type}  {_messages(len(times))}{rate}{mark}"
