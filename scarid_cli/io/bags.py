"""Recordings of ROS: MCAP, rosbag2 (SQLite) and ROS 1 (extra `logs`: rosbags)."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from scarid_cli.errors import BadData, ScaridError, UsageFault
from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.cdr import Definitions
from scarid_cli.io.unended import ended, has_no_end

# The eight bytes with which a recording begins, and the extension by which rosbags knows it.
BEGINNINGS = {b"\x89MCAP0\r\n": ".mcap", b"SQLite f": ".db3", b"#ROSBAG ": ".bag"}


@dataclass(frozen=True)
class Topic:
    """A topic of a recording: the type of its messages and how many there are."""

    name: str
    type: str
    messages: int
    connections: tuple[Any, ...]


@dataclass(frozen=True)
class Bag:
    """An open recording, whose messages are CDR unless it is one of ROS 1.

    It is `cut` if its end is missing.
    """

    name: str
    topics: tuple[Topic, ...]
    definitions: Definitions
    cdr: bool
    reader: Any
    cut: bool = False

    def messages(self, topic: Topic) -> Iterator[tuple[int, bytes]]:
        """The time at which each message was received [ns], and its bytes.

        Raises:
            BadData: there are other messages than the recording states, at its end.
        """
        count = 0
        with _readable(self.name):
            for _, received, data in self.reader.messages(topic.connections):
                count += 1
                yield received, data
        if count != topic.messages and not self.cut:
            raise BadData(
                f"{self.name}: {count:,} messages of {topic.name}, where the recording states "
                f"{topic.messages:,}; were some lost? `ros2 bag reindex` counts them again"
            )


def bag_extension(path: str, source: ByteSource) -> str | None:
    """The extension of a recording's format, by its first bytes; empty for a folder (rosbag2).

    None for anything else.
    """
    if Path(path).is_dir():
        return ""
    return BEGINNINGS.get(source.peek(8))


@contextlib.contextmanager
def open_bag(path: str, source: ByteSource, extension: str) -> Iterator[Bag]:
    """Open a recording: a file of this extension, or a folder with its metadata.yaml."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise UsageFault(
            f"{source.name}: reading ROS recordings needs rosbags: pip install 'scarid[logs]'"
        ) from None
    with contextlib.ExitStack() as stack:
        file = _named(path, source, extension, stack)
        cut = extension == ".mcap" and has_no_end(file)
        if cut:
            file = _ended(file, stack)
        with _readable(source.name):
            # A recording before 2023 has no definitions; the usual types are those of Humble.
            store = get_typestore(Stores.ROS2_HUMBLE)
            reader = AnyReader(_parts(file), default_typestore=store)
            stack.enter_context(reader)
            fields = {**store.fielddefs, **reader.typestore.fielddefs}
            topics = tuple(_topics(reader))
        yield Bag(source.name, topics, fields, reader.is2, reader, cut)


def _ended(path: Path, stack: contextlib.ExitStack) -> Path:
    """What there is of a recording without an end, with one."""
    import tempfile

    copy = Path(stack.enter_context(tempfile.TemporaryDirectory()), "recording.mcap")
    ended(path, copy)
    return copy


def _parts(path: Path) -> list[Path]:
    """The recording; of a folder that has lost its metadata.yaml, the files of one kind in it."""
    if not path.is_dir() or (path / "metadata.yaml").exists():
        return [path]
    for extension in BEGINNINGS.values():
        if files := sorted(path.glob(f"*{extension}")):
            return files
    return [path]


def _topics(reader: Any) -> Iterator[Topic]:
    by_name: dict[tuple[str, str], list[Any]] = {}
    for connection in reader.connections:
        by_name.setdefault((connection.topic, connection.msgtype), []).append(connection)
    for (name, kind), group in sorted(by_name.items()):
        yield Topic(name, kind, sum(one.msgcount for one in group), tuple(group))


def _named(path: str, source: ByteSource, extension: str, stack: contextlib.ExitStack) -> Path:
    """The recording under a name with its extension: itself, a link to it, or a copy of a pipe."""
    if path != "-" and source.regular and Path(path).suffix == extension:
        return Path(path)
    if not extension:
        return Path(path)
    import shutil
    import tempfile

    folder = stack.enter_context(tempfile.TemporaryDirectory())
    named = Path(folder, f"recording{extension}")
    if path != "-" and source.regular:
        named.symlink_to(Path(path).resolve())
    else:
        with named.open("wb") as copy:
            shutil.copyfileobj(source.seekable(), copy)
    return named


@contextlib.contextmanager
def _readable(name: str) -> Iterator[None]:
    """Report what a library says of a broken recording: it raises errors of any kind."""
    try:
        yield
    except (ScaridError, GeneratorExit):
        raise
    except Exception as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise BadData(
            f"{name}: not a readable recording ({reason}); convert it with `ros2 bag convert`, "
            "or record it again"
        ) from None
