"""The rate at which a log is to be resampled."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from stages.tables import table

from scarid_cli.algorithms.processes.rates import mean_rate, rate_text
from scarid_cli.arrays import Array
from scarid_cli.stages.records.rates import advised_rate

ROWS = 3000


def stamps(rate: float) -> Array:
    return np.asarray(np.arange(ROWS) / rate)


def random(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


def wandering(seed: int) -> Array:
    """Intervals that differ by 10 %, whose errors add up."""
    return np.asarray(np.cumsum(0.004 * (1.0 + 0.1 * random(seed).standard_normal(ROWS))))


CLOCKS: dict[str, tuple[Callable[[int], Array], str]] = {
    "regular": (lambda _: stamps(250.0), "250"),
    "of a round period": (lambda _: stamps(1.0 / 0.003), "333.333"),
    "of no round rate": (lambda _: stamps(137.3), "137"),
    "rounded to milliseconds": (lambda _: np.round(stamps(400.0), 3), "400"),
    "rounded, faster": (lambda _: np.round(stamps(700.0), 3), "700"),
    "late rows": (lambda k: stamps(250.0) + 0.003 * random(k).random(ROWS), "250"),
    "wandering": (wandering, "250"),
    "lost rows": (lambda k: stamps(250.0)[random(k).random(ROWS) > 0.03], "250"),
    "a gap": (lambda _: np.delete(stamps(500.0), np.arange(800, 1700)), "500"),
    "a repeated time": (lambda _: np.repeat(stamps(100.0), 2), "100"),
}


@pytest.mark.parametrize("name", CLOCKS)
def test_the_rate_of_a_clock_is_its_mean_rate_without_gaps(name: str) -> None:
    clock, rate = CLOCKS[name]
    for seed in range(5):
        assert rate_text(mean_rate(np.diff(clock(seed)))) == rate


@pytest.mark.parametrize("t", [[], [1.0], [2.0, 2.0], [3.0, 2.0, 1.0]])
def test_a_time_that_never_increases_has_no_rate(t: list[float]) -> None:
    assert mean_rate(np.diff(t)) == 0.0


def test_the_rate_of_a_log_with_held_samples_is_that_of_its_sensors() -> None:
    t = np.round(np.arange(4000) / 400.0, 3)
    held = np.floor(np.arange(4000) / 4.0)
    columns = {"t": t, "q1": np.sin(0.1 * held), "tau1": np.cos(0.1 * held)}
    assert advised_rate(next(table(columns, [4000]).batches)) == "100"
