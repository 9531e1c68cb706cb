"""A few faults of the kinds that `make faults` injects in numbers: none has a forbidden outcome."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import pytest
from faults import crafted, damage, processes, settings
from faults.trials import RIGHT, Trial, outcome

FEW = 2
ALLOWED = ("right result", "refused in one line", "not noticed by the format")


def quick() -> Iterator[tuple[str, Iterator[Trial]]]:
    for name in ("log.parquet", "log.arrows", "log.arrow", "log.csv", "arm.urdf", "settings.toml"):
        yield f"{name} cut", damage.cuts(name, FEW)
        yield f"{name} with a flipped bit", damage.flips(name, FEW)
    yield "metadata", damage.metadata(FEW)
    for kind, made in crafted.KINDS.items():
        yield kind, made(4 * FEW)
    yield "outputs", itertools.islice(crafted.outputs(), 2 * FEW)
    yield "options", settings.options(2 * FEW)
    yield "environments", itertools.islice(settings.environments(), 2 * FEW)
    yield "full disks", processes.limits(FEW)


@pytest.mark.parametrize(
    ("name", "trials"), list(quick()), ids=lambda x: x if isinstance(x, str) else ""
)
def test_a_fault_is_refused_or_changes_nothing(name: str, trials: Iterator[Trial]) -> None:
    for trial in trials:
        assert outcome(trial) in ALLOWED, (trial.name, trial.words)


def test_writers_at_the_same_time_leave_the_output_of_one() -> None:
    assert [found for _, found in processes.together(1)] == [RIGHT]
