"""A streaming stage needs no more memory for a longer log."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import long, seeds
from memory import SCARID, measured, peak, stages


@pytest.mark.parametrize(
    "name",
    [
        *("resample", "identify"),
        *(pytest.param(name, marks=long) for name in ("filter", "differentiate", "validate")),
    ],
)
def test_memory_does_not_grow_with_the_log(name: str, tmp_path: Path) -> None:
    words = stages(tmp_path)[name]
    short, _ = peak(words, 50_000)
    whole, _ = peak(words, len(seeds(250_000, 1_000_000)))
    assert whole < 1.1 * short


def test_memory_of_stages_in_one_process_does_not_grow_with_the_log() -> None:
    chain = ["filter", "then", "differentiate", "then", "identify", "-q"]
    assert peak(chain, len(seeds(200_000, 500_000)))[0] < 1.1 * peak(chain, 50_000)[0]


def test_memory_of_the_simulator_does_not_grow_with_a_standstill() -> None:
    def peak_of(seconds: int) -> float:
        source = [SCARID, "trajgen", "-q", "--duration", "2", "--format", "arrow"]
        stage = [
            SCARID,
            "simulate",
            f"--with=standstill-after={seconds}",
            "--with=torque-delay=0.1",
        ]
        return measured(source, [*stage, "--with=stamp-jitter=1e-4", "--format", "arrow"])[0]

    assert peak_of(len(seeds(400, 1000))) < 1.1 * peak_of(20)
