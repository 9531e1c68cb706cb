"""Torques of another topic of a recording than the positions."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bags import MILLISECOND, START, STATE, state, table, write_mcap
from conftest import Result, refused

Run = Callable[..., Result]


def test_messages_without_efforts_are_left_out_and_told(scarid: Run, tmp_path: Path) -> None:
    messages = []
    for k in range(10):
        when = START + k * MILLISECOND
        effort = {"effort": [2.0 * k]} if k % 5 else {}
        messages.append(("/s", when, state(when, ["a"], position=[float(k)], **effort)))
    path = write_mcap(tmp_path / "x.mcap", {"/s": STATE}, messages)
    result = scarid("convert", path)
    columns, values = table(result.out)
    assert columns == ["t", "q1", "tau1"]
    np.testing.assert_array_equal(values[:, 1], [k for k in range(10) if k % 5])
    assert "2 messages of /s left out: they have no tau (--torque-topic /s joins" in result.err


@pytest.mark.parametrize("join", ["linear", "hold"])
def test_efforts_of_a_slower_topic_are_joined(join: str, scarid: Run, tmp_path: Path) -> None:
    """Positions at 1000 Hz, efforts at 100 Hz from 5.5 ms on: what numpy finds is the same."""
    ms = np.arange(0, 200)
    slow = np.arange(5.5, 180.0, 10.0)
    effort = np.sin(slow)
    messages = [
        ("/state", START + int(k) * MILLISECOND, state(START + int(k) * MILLISECOND, ["a"],
         position=[float(k)])) for k in ms
    ]  # fmt: skip
    for when, x in zip(slow, effort, strict=True):
        at = START + round(when * MILLISECOND)
        messages.append(("/effort", at, state(at, ["a"], effort=[x])))
    path = write_mcap(
        tmp_path / "x.mcap",
        {"/state": STATE, "/effort": STATE},
        sorted(messages, key=lambda m: m[1]),
    )
    words = ("convert", path, "--topic", "/state", "--torque-topic", "/effort", "--join", join)
    result = scarid(*words)
    _, values = table(result.out)
    kept = ms[(ms >= 5.5) & ((ms <= slow[-1]) if join == "linear" else True)]
    np.testing.assert_allclose(values[:, 1], kept)
    expected = np.interp(kept, slow, effort)
    age = 9.5
    if join == "hold":
        expected = effort[np.searchsorted(slow, kept, side="right") - 1]
        age = 199 - slow[-1]
    np.testing.assert_allclose(values[:, 2], expected, atol=1e-9)
    assert f"at most {age:.3g} ms old" in result.err
    assert scarid(*words, "-o", tmp_path / "x.parquet").status == 0
    told = scarid("info", tmp_path / "x.parquet").out
    assert f"join      {join}" in told
    assert f"largest_age {1e-3 * age:.6g}" in told


@pytest.mark.parametrize("join", ["linear", "hold"])
def test_efforts_of_another_time_are_not_joined(join: str, scarid: Run, tmp_path: Path) -> None:
    """They begin when the positions have ended."""
    positions = [START + k * MILLISECOND for k in range(50)]
    efforts = [START + (k + 100) * MILLISECOND for k in range(50)]
    messages = [("/state", at, state(at, ["a"], position=[0.5])) for at in positions]
    messages += [("/effort", at, state(at, ["a"], effort=[0.5])) for at in efforts]
    path = write_mcap(tmp_path / "x.mcap", {"/state": STATE, "/effort": STATE}, messages)
    words = ("convert", path, "--topic", "/state", "--torque-topic", "/effort", "--join", join)
    refused(scarid(*words), 65, str(path), "recorded at different times", "--torque-topic")
