"""Files that were cut at a byte, or have lost a bit."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache

import numpy as np
import pyarrow.parquet as pq
from faults.material import ENDINGS, ROBOT, files
from faults.trials import OTHER, STDOUT, UNNOTICED, Trial, ended, folder_of, removed

# How each file is read; the output is standard output.
READERS = {
    **{f"log.{ending}": ("convert", f"log.{ending}") for ending in ENDINGS},
    "state.npz": ("identify", "-q", "motion.parquet", "--from", "state.npz"),
    "settings.toml": ("differentiate", "-q", "log.parquet", "--settings", "settings.toml"),
    ROBOT: ("identify", "-q", "motion.parquet", "--robot", ROBOT),
    "arm.urdf": ("robot", "check", "arm.urdf"),
    "arm.toml": ("robot", "check", "arm.toml"),
}
# Damage that leaves a file of the same format is not noticed where the format has no checksums.
CHECKED = ("log.parquet", "log.arrows", "log.arrow", "state.npz")


@cache
def expected(name: str) -> bytes:
    """What the undamaged file gives."""
    folder = folder_of(files())
    done = ended(Trial(name, READERS[name], folder))
    if done.status:
        raise RuntimeError(f"{name}: {done.error}")
    content = (folder / STDOUT).read_bytes()
    removed(folder)
    return content


def _damaged(name: str, contents: Iterator[tuple[str, bytes]]) -> Iterator[Trial]:
    right = expected(name)
    folder = folder_of(files())
    for place, content in contents:
        (folder / name).write_bytes(content)
        yield Trial(
            f"{name} {place}",
            READERS[name],
            folder,
            lambda at: (at / STDOUT).read_bytes() == right,
            OTHER if name in CHECKED or is_noticeable(name, content) else UNNOTICED,
        )
    removed(folder)


def is_noticeable(name: str, content: bytes) -> bool:
    """Whether this is CSV in which a row has not a number for each name of the header.

    The first row is left out, because it says which columns are numbers.
    """
    if not name.endswith(".csv"):
        return False
    header, *rows = content.removesuffix(b"\n").split(b"\n")
    return not all(_is_whole(row.split(b","), header.count(b",") + 1) for row in rows[1:])


def _is_whole(cells: list[bytes], columns: int) -> bool:
    """Whether these are so many numbers; the last one may be cut off as far as it goes."""
    try:
        list(map(float, cells[:-1] if cells[-1] in (b"", b"-") else cells))
    except ValueError:
        return False
    return len(cells) == columns


def cuts(name: str, count: int) -> Iterator[Trial]:
    """The file cut at every byte, or at so many of them."""
    content = files()[name]
    places = range(0, len(content), max(1, len(content) // count))
    return _damaged(name, ((f"cut at {n}", content[:n]) for n in places))


def flips(name: str, count: int) -> Iterator[Trial]:
    """The file with a bit flipped, at places drawn from a fixed seed."""
    content, rng = files()[name], np.random.default_rng(1)

    def damaged() -> Iterator[tuple[str, bytes]]:
        for place in rng.integers(len(content), size=count).tolist():
            bad = bytearray(content)
            bad[place] ^= 1 << int(rng.integers(8))
            yield f"bit at {place}", bytes(bad)

    return _damaged(name, damaged())


VALUES: tuple[object, ...] = (None, -1, 0, 1e308, "", "x" * 1000, "\x1b[2J\n", [], {}, [[]], True)


def metadata(count: int) -> Iterator[Trial]:
    """Parquet whose scarid metadata has another value at some place, or is no JSON."""
    rng, folder = np.random.default_rng(2), folder_of(files())
    table = pq.read_table(folder / "log.parquet")
    document = json.loads(table.schema.metadata[b"scarid"])
    for k in range(count):
        key = list(document)[int(rng.integers(len(document)))]
        value = VALUES[int(rng.integers(len(VALUES)))]
        text = json.dumps({**document, key: value}).encode()
        text = text if rng.random() < 0.8 else text[: int(rng.integers(len(text)))]
        pq.write_table(table.replace_schema_metadata({b"scarid": text}), folder / "log.parquet")
        command = ("info", "filter", "differentiate", "identify")[k % 4]
        words = (
            ("info", "log.parquet")
            if command == "info"
            else (command, "-q", "log.parquet", "-o", "out.csv")
        )
        yield Trial(f"{key} = {value!r}", words, folder)
    removed(folder)


def names() -> list[str]:
    """The files that are damaged."""
    return list(READERS)
