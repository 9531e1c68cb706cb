"""Find the settings of differentiators from a log, without knowing the true derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from math import isfinite, log2
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.likelihood import best_model
from scarid_cli.algorithms.processes.bandwidth import lowpass_bandwidth
from scarid_cli.algorithms.tuning import judges, search
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, TooShort
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, table_of
from scarid_cli.stages.records.record import Record

Settings = dict[str, list[float]]
Progress = Callable[[], object]
LIKELIHOOD, SMOOTHER, SCATTER, BANDWIDTH = "likelihood", "smoother", "scatter", "bandwidth"
OCTAVE = 1.0  # by which the bandwidths of the joints may differ before it is reported


@dataclass(frozen=True)
class Tried:
    """One row of the table of trials; `rows` is the number of rows that counted, if they were."""

    name: str
    judge: str
    trial: search.Trial
    best: bool
    rows: int | None = None

    @property
    def settings(self) -> str:
        return " ".join(f"{key}={value:.6g}" for key, value in values(self.trial.method).items())


def online() -> list[str]:
    """The causal methods."""
    return [n for n in DIFFERENTIATORS.names if DIFFERENTIATORS.load(n)().lag(1e-3) == 0]


def tune(record: Record, names: Sequence[str], seed: int, progress: Progress) -> list[Tried]:
    """All trials of these methods from the positions alone; the best of each method is marked."""
    rows: list[Tried] = []
    try:
        for name in names:
            method = DIFFERENTIATORS.load(name)()
            if method.HAS_LIKELIHOOD:
                rows += likely(name, method, record.longest, record.h)
            else:
                smoothers = [judges.smoother(q, record.h) for q in record.longest]
                rows += nearest(name, method, record, smoothers, seed, progress)
    except TooShort as reason:
        raise TooShort(f"{record.name}: {reason}") from None
    return rows


def likely(name: str, method: Any, q: Array, h: float) -> Iterator[Tried]:
    """The default settings of a Kalman method, if it has any, and the most likely ones."""
    likelihood = judges.negative_log_likelihood(q, h)
    fitted = best_model(method, q, h)
    for tried in (method, fitted) if values(method)["noise"] else (fitted,):
        yield Tried(name, LIKELIHOOD, search.Trial(tried, likelihood(tried)), tried is fitted)


def nearest(
    name: str,
    method: Any,
    record: Record,
    smoothers: Sequence[Any],
    seed: int,
    progress: Progress,
) -> Iterator[Tried]:
    """A search for the settings whose derivatives are nearest to those of the smoothers."""
    judge = judges.distance_to_smoothers(record.longest, smoothers, record.h)
    trials = []
    for trial in search.search(method, method.TUNED, judge, record.h, seed):
        trials.append(trial)
        progress()
    yield from _marked(name, trials)


def _marked(name: str, trials: Iterable[search.Trial]) -> Iterator[Tried]:
    """The trials of a search, with the best one marked."""
    trials = list(trials)
    best = min(trials, key=lambda trial: trial.loss if isfinite(trial.loss) else np.inf)
    if not isfinite(best.loss):
        raise BadData(
            f"{name}: no settings could be judged by the {SMOOTHER}; give a log that moves every "
            "joint"
        )
    for trial in trials:
        yield Tried(name, SMOOTHER, trial, trial is best)


def octaves(record: Record) -> tuple[float, list[float]]:
    """By how many octaves the joints' own most likely bandwidths differ, and these [Hz]."""
    kalman = DIFFERENTIATORS.load("kalman")()
    own = [best_model(kalman, q, record.h) for q in record.longest]
    found = [lowpass_bandwidth(method.matched().torque_filter, record.h) for method in own]
    return log2(max(found) / min(found)), found


def values(method: Any) -> dict[str, float]:
    """The settings of a method."""
    return {field.name: float(getattr(method, field.name)) for field in fields(method)}


def chosen(rows: Sequence[Tried], joints: int) -> dict[str, Settings]:
    """The chosen settings of each method, which are the same for all joints."""
    return {
        row.name: {key: [value] * joints for key, value in values(row.trial.method).items()}
        for row in rows
        if row.best and row.judge != SCATTER
    }


def trials(table: Table, rows: Sequence[Tried]) -> Table:
    """The table of all trials."""
    schema = schemas.load("trials").arrow()
    found = (
        (row.name, row.settings, row.judge, float(row.trial.loss), row.rows, int(row.best))
        for row in rows
    )
    return table_of("tune", schema, found, replace(table.meta, kind="trials"))
