"""Mutated metadata in tables of every kind: a result, or an error of ours, from every command."""

from __future__ import annotations

import contextlib
import copy
import io
import json
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq
import pytest
from conftest import ROOT
from fuzz.support import fuzzed, promptly
from hypothesis import given
from hypothesis import strategies as st

from scarid_cli.__main__ import main
from scarid_cli.io.table import Metadata

JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-3, 9) | st.floats() | st.text(max_size=3)
    | st.sampled_from([2**70, -(2**70), "motion", "x", "../x", "scara2", "x.toml", "\x1b"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=3), inner),
    max_leaves=6,
)  # fmt: skip


@fuzzed(3.0)
@given(st.binary(max_size=60) | JSON.map(json.dumps).map(str.encode))
def test_any_bytes_are_metadata_or_a_value_error(document: bytes) -> None:
    with contextlib.suppress(ValueError, KeyError, TypeError, RecursionError):
        meta = Metadata.from_json(document)
        assert Metadata.from_json(meta.to_json()) == meta


@pytest.fixture(scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A table of each kind that commands read, with its metadata."""
    folder = tmp_path_factory.mktemp("tables")
    paths = {
        kind: folder / f"{kind}.parquet" for kind in ("log", "motion", "parameters", "metrics")
    }
    log = str(ROOT / "samples" / "scara2.csv")
    for words in (
        ["convert", log, "-o", "log"],
        ["differentiate", "log", "-o", "motion"],
        ["identify", "--robot", "scara2", log, "-o", "parameters"],
        ["validate", "--parameters", "parameters", "motion", "-o", "metrics"],
    ):
        assert main([str(paths.get(word, word)) for word in words]) == 0
    return paths


# The table that is mutated, and a command that reads it.
COMMANDS = {
    "info": "any",
    "info --json": "any",
    "report": "any",
    "convert -o OUT": "any",
    "identify --robot scara2 --estimator ls -o OUT": "motion",
    "identify --require good -o OUT": "motion",
    "validate --parameters parameters -o OUT": "motion",
    "validate -o OUT motion --parameters": "parameters",
    "compare parameters": "parameters",
    "filter -o OUT": "log",
    "differentiate -o OUT": "log",
    "check": "log",
    "simulate -o OUT": "log",
}


@st.composite
def changed(draw: st.DrawFn, document: dict[str, Any]) -> dict[str, Any]:
    """The metadata with one to three values that are others, or are not there."""
    document = copy.deepcopy(document)
    for _ in range(draw(st.integers(1, 3))):
        place: Any = document
        while place:
            key = draw(
                st.sampled_from(list(place) if isinstance(place, dict) else range(len(place)))
            )
            if isinstance(place[key], dict | list) and place[key] and draw(st.integers(0, 4)):
                place = place[key]
                continue
            if draw(st.booleans()) and isinstance(place, dict):
                del place[key]
            else:
                place[key] = draw(JSON)
            break
    return document


@fuzzed()
@given(st.data())
def test_a_command_understands_or_refuses_any_metadata(
    tables: dict[str, Path], data: st.DataObject
) -> None:
    command = data.draw(st.sampled_from(list(COMMANDS)))
    kind = COMMANDS[command]
    if kind == "any":
        kind = data.draw(st.sampled_from(list(tables)))
    table = pq.read_table(tables[kind])
    document = data.draw(changed(json.loads(table.schema.metadata[b"scarid"])))
    folder = tables[kind].parent
    mutant = folder / "mutant.parquet"
    pq.write_table(table.replace_schema_metadata({b"scarid": json.dumps(document)}), mutant)
    known = {**{k: str(p) for k, p in tables.items()}, "OUT": str(folder / "out.arrow")}
    words = [known.get(word, word) for word in command.split()]
    status, said = quietly([*words, str(mutant)])
    assert status in (0, 2, 3, 65), said
    assert status not in (2, 65) or said.count("\n") == 1


def quietly(words: list[str]) -> tuple[int, str]:
    """The status of a command, and what it says on standard error."""
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error), promptly():
        return main([*words]), error.getvalue()
