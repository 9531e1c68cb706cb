"""Joint states as `ros2 topic echo` and `rostopic echo` print them."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from conftest import Shell
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.io.bytesource import ByteSource
from scarid_cli.io.echoed_yaml import is_echoed, read_echoed

JOINTS = ("wrist", "base", "elbow")
ROWS = 25
VALUES = np.random.default_rng(8).standard_normal((ROWS, 6))


def listed(key: str, values: Sequence[object], style: str) -> str:
    if style == "ros2" and values:
        return f"{key}:\n" + "".join(f"- {x}\n" for x in values)
    return f"{key}: [{', '.join(map(str, values))}]\n"


def message(k: int, style: str) -> str:
    """The k-th message, in one of the forms of these commands."""
    sec, nanosec = ("secs", "nsecs") if style == "ros1" else ("sec", "nanosec")
    space = " " if style == "ros1" else ""
    stamp = f"    {sec}: {1_700_000_000 + k}\n    {nanosec}: {k * 1000:>9}\n"
    head = f"header:{space}\n  stamp:{space}\n{stamp}  frame_id: ''\n"
    position, effort = VALUES[k, :3].tolist(), VALUES[k, 3:].tolist()
    lists = (("name", JOINTS), ("position", position), ("velocity", ()), ("effort", effort))
    return head + "".join(listed(key, own, style) for key, own in lists) + "---\n"


def printed(style: str) -> str:
    return "".join(message(k, style) for k in range(ROWS))


@pytest.mark.parametrize("style", ["ros1", "ros2", "flow"])
def test_printed_joint_states_are_a_log(style: str, shell: Shell, tmp_path: Path) -> None:
    (tmp_path / "echo.txt").write_text(printed(style))
    done = shell("scarid convert --joints base,elbow,wrist echo.txt")
    assert done.status == 0, done.err
    order = ["t", *(f"q{i}" for i in (3, 1, 2)), *(f"tau{i}" for i in (3, 1, 2))]
    rows = csv.DictReader(done.out.splitlines())
    found = np.array([[float(row[name]) for name in order] for row in rows])
    np.testing.assert_allclose(found[:, 0], np.arange(ROWS) * (1.0 + 1e-6), atol=1e-7)
    np.testing.assert_array_equal(found[:, 1:], VALUES)
    refused = shell("scarid check echo.txt")
    assert "YAML; convert it first: `scarid convert echo.txt -o log.parquet`" in refused.err


@settings(max_examples=60, deadline=None)
@given(style=st.sampled_from(["ros1", "ros2", "flow"]), share=st.floats(0.05, 1.0))
def test_of_messages_that_are_cut_anywhere_the_whole_ones_are_read(
    style: str, share: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    text = printed(style)
    cut = text[: int(share * len(text))]
    path = tmp_path_factory.getbasetemp() / "cut.txt"
    path.write_text(cut)
    said: list[str] = []
    with path.open("rb") as file:
        source = ByteSource(file.fileno(), "cut.txt")
        assert is_echoed(source)
        rows = sum(batch.num_rows for batch in read_echoed(source, said.append).batches)
    assert rows == cut.count("\n---")
    assert bool(said) == bool(cut.rpartition("\n---")[2].strip())


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (printed("ros2").replace("- elbow", "- ..."), "cut short by ..."),
        ("points:\n- positions: [1]\n---\n", "found line 2: '- positions: [1]'"),
        (message(0, "ros2").replace("---\n", ""), "no message with --- after it"),
    ],
)
def test_other_yaml_is_refused_with_what_to_do(
    text: str, why: str, shell: Shell, tmp_path: Path
) -> None:
    (tmp_path / "echo.txt").write_text(text)
    done = shell("scarid convert echo.txt")
    assert done.status == 65
    assert why in done.err
    assert done.out == ""
