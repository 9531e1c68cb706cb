"""Files that are whole by their checksums, and contain what no command of ours writes."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from faults.material import files
from faults.trials import UNNOTICED, Trial, folder_of, removed

NUMBERS = ("", "nan", "inf", "-inf", "1e308", "-1e200", "1e400", "x", "0", "1" * 400)
VALUES: tuple[Any, ...] = (None, -1, 0, 1e308, 2**70, "x", [], {}, True, {"value": 1},
                           {"items": []}, {"array": "a0"}, {"array": "none"}, {"kind": "Rows"})  # fmt: skip
MEMBERS = (b"", b"hello", b"\x93NUMPY", b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'}" + b" " * 200)


def _crafted(name: str, words: tuple[str, ...], folder: Path) -> Trial:
    """A trial of which exit 0 says only that the content may be one: nobody knows the right one."""
    return Trial(name, words, folder, lambda _: False, UNNOTICED)


def states(count: int) -> Iterator[Trial]:
    """Saved states of which one array or one value of the structure is another."""
    rng, folder = np.random.default_rng(11), folder_of(files())
    with np.load(folder / "state.npz") as archive:
        arrays = {name: archive[name] for name in archive.files}
    for _ in range(count):
        bad, tree = dict(arrays), json.loads(str(arrays["tree"]))
        if rng.random() < 0.5:
            name = str(rng.choice([name for name in arrays if name != "tree"]))
            bad[name], what = _other(arrays[name], rng)
        else:
            name, what = _changed(tree, rng)
            bad["tree"] = np.array(json.dumps(tree))
        np.savez(folder / "state.npz", **bad)
        words = ("identify", "-q", "motion.parquet", "--from", "state.npz", "-o", "out.csv")
        yield _crafted(f"{name}: {what}", words, folder)
    removed(folder)


def _other(array: Any, rng: np.random.Generator) -> tuple[Any, str]:
    """The array with another shape, type or value."""
    kinds = {
        "flat": array.ravel(),
        "shorter": array[:-1],
        "longer": np.concatenate([array, array]),
        "turned": array.T,
        "none": np.zeros(0),
        "a number": np.array(1.0),
        "text": np.full(array.shape, "x"),
        "complex": array.astype(complex),
        "short": array.astype(np.float32),
        "nan": np.full(array.shape, np.nan),
        "large": np.full(array.shape, 1e200),
        "negative": -array,
    }
    what = str(rng.choice(list(kinds)))
    return kinds[what], what


def _changed(tree: Any, rng: np.random.Generator) -> tuple[str, str]:
    """Put another value at a random place of the structure."""
    places: list[tuple[Any, Any, str]] = []

    def walk(node: Any, path: str) -> None:
        items = node.items() if isinstance(node, dict) else enumerate(node)
        for key, value in items:
            places.append((node, key, f"{path}.{key}"))
            if isinstance(value, dict | list):
                walk(value, f"{path}.{key}")

    walk(tree, "")
    node, key, path = places[int(rng.integers(len(places)))]
    value = VALUES[int(rng.integers(len(VALUES)))]
    node[key] = value
    return path, repr(value)


def parameters(count: int) -> Iterator[Trial]:
    """Tables of parameters as text, with another cell."""
    rng, folder = np.random.default_rng(12), folder_of(files())
    from faults.material import made

    made(folder, "convert", "-q", "par.parquet", "-o", "par.csv")
    header, *rows = (folder / "par.csv").read_text().splitlines()
    commands = (
        ("validate", "-q", "motion.parquet", "--parameters", "bad.csv", "-o", "out.csv"),
        ("compare", "bad.csv", "par.csv", "-o", "out.csv"),
        ("report", "bad.csv", "--html", "out.html"),
        ("identify", "-q", "motion.parquet", "--estimator", "rls", "--initial", "bad.csv", "-o", "out.csv"),
    )  # fmt: skip
    for k in range(count):
        row, value = int(rng.integers(len(rows))), str(rng.choice(NUMBERS))
        cells = rows[row].split(",")
        column = int(rng.integers(len(cells)))
        cells[column] = value
        text = [header, *rows[:row], ",".join(cells), *rows[row + 1 :]]
        (folder / "bad.csv").write_text("\n".join(text) + "\n")
        yield _crafted(f"row {row + 1}, {column}: {value[:9]}", commands[k % len(commands)], folder)
    removed(folder)


def archives(count: int) -> Iterator[Trial]:
    """Archives of arrays with a member of another kind, name or content."""
    rng, folder = np.random.default_rng(13), folder_of({})
    t = np.arange(200.0) / 100.0
    for _ in range(count):
        arrays = {"t": t, "q1": np.sin(t), "tau1": np.cos(t)}
        name = str(rng.choice(list(arrays)))
        arrays[name], what = _other(arrays[name], rng)
        with io.BytesIO() as out:
            np.savez(out, **arrays)
            with zipfile.ZipFile(out, "a") as archive:
                if rng.random() < 0.5:
                    member = str(
                        rng.choice(["readme.txt", "a/", "q2.npy", "../x.npy", "\x1b[2J.npy"])
                    )
                    archive.writestr(member, MEMBERS[int(rng.integers(len(MEMBERS)))])
                    what += f", {member!r}"
            (folder / "log.npz").write_bytes(out.getvalue())
        yield _crafted(f"{name}: {what}", ("convert", "-q", "log.npz", "-o", "out.csv"), folder)
    removed(folder)


def signals(count: int) -> Iterator[Trial]:
    """Logs with a value that no sensor gives."""
    rng, folder = np.random.default_rng(14), folder_of(files())
    header, *rows = files()["log.csv"].decode().splitlines()
    for k in range(count):
        row, column = int(rng.integers(len(rows))), int(rng.integers(header.count(",") + 1))
        value = str(rng.choice(NUMBERS))
        bad = [line.split(",") for line in rows]
        for cells in bad if rng.random() < 0.3 else [bad[row]]:
            cells[column] = value
        (folder / "log.csv").write_text("\n".join([header, *map(",".join, bad)]) + "\n")
        command = ("check", "identify", "differentiate", "info", "tune")[k % 5]
        words = (command, "log.csv") if command in ("check", "info") else (command, "-q", "log.csv", "-o", "out.csv")  # fmt: skip
        words = (*words[:2], "log.csv", "--save", "out.toml") if command == "tune" else words
        yield _crafted(f"row {row + 1}, {column}: {value[:9]}", words, folder)
    removed(folder)


def outputs() -> Iterator[Trial]:
    """Commands joined with `then`, of which two write one file under any spelling."""
    folder = folder_of(files())
    (folder / "sub").mkdir()
    for one in ("out.csv", "./out.csv", "sub/../out.csv"):
        for other in ("out.csv", "././out.csv", str(folder / "out.csv")):
            for last in (("filter", "-q", "--cutoff", "10", "-o"), ("tee",)):
                words = ("convert", "-q", "log.parquet", "then", "tee", one, "then", *last, other)
                yield Trial(f"{one} and {other}", words, folder, lambda _: False)
    removed(folder)


KINDS = {
    "crafted states": states,
    "crafted tables of parameters": parameters,
    "crafted archives": archives,
    "crafted logs": signals,
}
