"""Find the settings of differentiators from a log, without knowing the true derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from math import isfinite
from typing import Any

import numpy as np

from scarid_cli.algorithms.choices.ranges import Range
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning import judges, search
from scarid_cli.algorithms.tuning.likelihood import best_model
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, TooShort
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, matrix, segments, table_of

Settings = dict[str, list[float]]
LIKELIHOOD, SMOOTHER, TORQUES = "likelihood", "smoother", "torques"


@dataclass(frozen=True)
class Tried:
    """One row of the table of trials; `joint` is None if all joints share the settings."""

    name: str
    joint: int | None
    judge: str
    trial: search.Trial
    best: bool

    @property
    def settings(self) -> str:
        return " ".join(f"{key}={value:.6g}" for key, value in values(self.trial.method).items())


@dataclass(frozen=True)
class Record:
    """Positions and torques (joints, rows) of a log, sampled every h [s].

    If the log has gaps, the record is its longest segment.
    """

    q: Array
    tau: Array | None
    h: float
    name: str = "log"

    @classmethod
    def of(cls, table: Table, joints: int, *, torques: bool) -> Record:
        names = schemas.of_joints(joints, *("q{i}", "tau{i}")[: 1 + torques])
        parts = (
            np.concatenate([matrix(batch, names) for batch in segment.batches], axis=1)
            for segment in segments(table)
        )
        rows = max(parts, key=lambda part: part.shape[1])
        tau = np.ascontiguousarray(rows[joints:]) if torques else None
        q = np.ascontiguousarray(rows[:joints])
        return cls(q, tau, table.period, table.name)


def online() -> list[str]:
    """The causal methods."""
    return [n for n in DIFFERENTIATORS.names if DIFFERENTIATORS.load(n)().lag(1e-3) == 0]


def tune(
    record: Record, names: list[str], robot: Robot | None, seed: int, progress: Callable[[], object]
) -> list[Tried]:
    """All trials of these methods; the chosen one of each method and joint is marked `best`."""
    rows: list[Tried] = []
    try:
        for name in names:
            method = DIFFERENTIATORS.load(name)()
            if robot:
                rows += _for_torques(name, method, record, robot, seed, progress)
                continue
            for joint, q in enumerate(record.q, start=1):
                rows += _for_positions(name, method, joint, q, record.h, seed, progress)
    except TooShort as reason:
        raise TooShort(f"{record.name}: {reason}") from None
    return rows


def _for_positions(
    name: str,
    method: Any,
    joint: int,
    q: Array,
    h: float,
    seed: int,
    progress: Callable[[], object],
) -> Iterator[Tried]:
    judge = judges.distance_to_smoother(q, h)
    if method.HAS_LIKELIHOOD:
        likelihood = judges.negative_log_likelihood(q, h)
        fitted = best_model(method, q, h)
        for tried in (method, fitted) if values(method)["noise"] else (fitted,):
            trial = search.Trial(tried, likelihood(tried))
            yield Tried(name, joint, LIKELIHOOD, trial, tried is fitted)
        yield Tried(name, joint, SMOOTHER, search.Trial(fitted, judge(fitted)), best=True)
        return
    trials = search.search(method, method.TUNED, judge, h, seed)
    yield from _marked(name, joint, SMOOTHER, trials, progress)


def _for_torques(
    name: str, method: Any, record: Record, robot: Robot, seed: int, progress: Callable[[], object]
) -> Iterator[Tried]:
    assert record.tau is not None
    judge = judges.error_of_torques(robot, record.q, record.tau, record.h)
    ranges = method.TUNED
    if method.HAS_LIKELIHOOD:
        # The most likely intensity also follows vibrations; a lower one may identify better.
        method = best_model(method, record.q, record.h)
        ranges = {"intensity": Range(1e-12 * method.intensity, 1e2 * method.intensity)}
    trials = search.search(method, ranges, judge, record.h, seed)
    yield from _marked(name, None, TORQUES, trials, progress)


def _marked(
    name: str,
    joint: int | None,
    judge: str,
    search_of_settings: Iterable[search.Trial],
    progress: Callable[[], object],
) -> Iterator[Tried]:
    """The trials of a search, with the best one marked; `progress` is called after each."""
    trials = []
    for trial in search_of_settings:
        trials.append(trial)
        progress()
    best = min(trials, key=lambda trial: trial.loss if isfinite(trial.loss) else np.inf)
    if not isfinite(best.loss):
        raise BadData(
            f"{name}: no settings could be judged by the {judge}; give a log that moves every "
            "joint and, with --robot, excites every parameter"
        )
    for trial in trials:
        yield Tried(name, joint, judge, trial, trial is best)


def values(method: Any) -> dict[str, float]:
    """The settings of a method."""
    return {field.name: float(getattr(method, field.name)) for field in fields(method)}


def chosen(rows: list[Tried], joints: int) -> tuple[str, dict[str, Settings]]:
    """The best method and, for each, the chosen settings per joint."""
    settings: dict[str, Settings] = {}
    losses: dict[str, float] = {}
    for row in rows:
        if not row.best or row.judge == LIKELIHOOD:
            continue
        losses[row.name] = losses.get(row.name, 0.0) + row.trial.loss
        mine = settings.setdefault(row.name, {})
        for key, value in values(row.trial.method).items():
            mine.setdefault(key, []).extend([value] * (joints if row.joint is None else 1))
    return min(losses, key=lambda name: losses[name]), settings


def trials(table: Table, rows: list[Tried]) -> Table:
    """The table of all trials."""
    schema = schemas.load("trials").arrow()
    found = (
        (row.name, row.joint, row.settings, row.judge, float(row.trial.loss), int(row.best))
        for row in rows
    )
    return table_of("tune", schema, found, replace(table.meta, kind="trials"))
