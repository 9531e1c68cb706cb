"""Remarks come with a result: a run that is refused says in one line why, and nothing else."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from conftest import Result, refused

Run = Callable[..., Result]


def test_a_refusal_late_in_a_run_stands_alone(scarid: Run, samples: Path) -> None:
    log = samples / "scara2.csv"
    assert scarid("identify", log).err.count("\n") > 1  # among them the choice of the bandwidth
    refused(scarid("identify", "--decimate", "1e300", log), 65, "one row in 1e+300", "longer log")


@pytest.mark.parametrize("option", ["--save", "-o"])
def test_an_output_that_cannot_be_written_is_all_that_is_told(
    option: str, scarid: Run, samples: Path
) -> None:
    found = scarid("tune", samples / "scara2.csv", option, "/dev/full")
    assert (found.status, found.err.count("\n")) == (74, 1)
    assert "/dev/full" in found.err
