"""The first screen of a study over many experiments: which method is best, how often, how much."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

import numpy as np

from scarid_cli.algorithms.inference.verdict import DOUBT, GOOD, GRADES
from scarid_cli.reporting.kinds import Metrics, Parameters, Result
from scarid_cli.reporting.study.league import League, Place, joint_percents, percents
from scarid_cli.reporting.study.opening import (
    BELIEF,
    EXPERIMENTS,
    ROWS,
    Opening,
    counted,
    others,
)
from scarid_cli.reporting.study.ranking import Standing, judge_of
from scarid_cli.reporting.wording import of_kind

QUARTILES = (0.25, 0.5, 0.75)


@dataclass(frozen=True)
class Repeated:
    """A method, and its standing in each experiment in which it has parameters or torques."""

    label: str
    standings: tuple[Standing, ...]

    @property
    def grades(self) -> list[str]:
        """The verdicts that are known, the best first."""
        known = [s.grade for s in self.standings if s.grade in GRADES]
        return sorted(known, key=GRADES.index)

    @property
    def grade(self) -> str:
        """The verdict of the median experiment; "" if none is known."""
        return self.grades[len(self.grades) // 2] if self.grades else ""

    def scores(self, judge: str | None) -> list[float]:
        """The torque errors of the experiments [%] (`Standing.score`), those that are known."""
        found = [s.score(judge) for s in self.standings] if judge is not None else []
        return [score for score in found if isfinite(score)]

    def quartiles(self, judge: str | None) -> list[tuple[float, float, float]]:
        """Quartiles of the torque errors of each joint [%], or else of the parameters' errors."""
        rows = [s.errors(judge) for s in self.standings] if judge is not None else []
        rows = [row for row in rows if row]
        columns = list(zip(*rows, strict=False)) or [tuple(s.vagueness() for s in self.standings)]
        return [_quartiles(column) for column in columns]

    def medians(self, judge: str | None) -> list[float]:
        """The middle ones of `quartiles`."""
        return [middle for _, middle, _ in self.quartiles(judge)]


def _quartiles(values: Sequence[float]) -> tuple[float, float, float]:
    known = [value for value in values if isfinite(value)]
    low, middle, high = np.quantile(known, QUARTILES).tolist() if known else (inf,) * 3
    return low, middle, high


@dataclass(frozen=True)
class Ranked:
    """The methods, the best first, and the experiment whose torques decided (`Ranking.judge`)."""

    methods: tuple[Repeated, ...]
    judge: str | None

    @property
    def count(self) -> int:
        """The number of experiments of the method that has most."""
        return max(len(method.standings) for method in self.methods)

    def in_order(self, results: Sequence[Result]) -> list[Result]:
        """The results of the best method first; those of methods without a place last."""
        places = {method.label: place for place, method in enumerate(self.methods)}
        return sorted(results, key=lambda r: places.get(r.name.label, len(places)))


def ranked(results: Sequence[Result]) -> Ranked:
    """Order by the median verdict, then the median torque error, then that of the parameters."""
    metrics = [r for r in of_kind(results, Metrics) if not r.name.published]
    judge = judge_of(metrics)

    def key(method: Repeated) -> tuple[int, float, float]:
        grade = GRADES.index(method.grade) if method.grade else len(GRADES)
        scores = method.scores(judge)
        vague = float(np.median([s.vagueness() for s in method.standings]))
        return grade, float(np.median(scores)) if scores else inf, vague

    return Ranked(tuple(sorted(_methods(of_kind(results, Parameters), metrics), key=key)), judge)


def opening(found: Ranked) -> Opening:
    """What a reader needs to know of a study in which every experiment was repeated."""
    methods, best = found.methods, found.methods[0]
    answers = [("How well?", _how_well(found)), ("May I believe it?", _belief(best))]
    if len(methods) > 1:
        answers.append(("And the others?", counted([(m.label, m.grade) for m in methods])))
    return Opening.of(best.grade, _headline(found), answers, _figure(found))


def _methods(parameters: Sequence[Parameters], metrics: Sequence[Metrics]) -> list[Repeated]:
    """The methods; the k-th tables of one name belong to the k-th experiment."""
    estimates: dict[str, list[Parameters]] = {}
    for one in parameters:
        if not one.name.experiment and not one.name.published:
            estimates.setdefault(one.name.label, []).append(one)
    torques: dict[str, dict[str, list[Metrics]]] = {}
    for each in metrics:
        own = torques.setdefault(each.name.label, {})
        own.setdefault(each.name.experiment, []).append(each)
    labels = dict.fromkeys([*estimates, *torques])
    return [_repeated(name, estimates.get(name, []), torques.get(name, {})) for name in labels]


def _repeated(label: str, own: list[Parameters], torques: dict[str, list[Metrics]]) -> Repeated:
    count = max(len(own), *(len(tables) for tables in torques.values()), 0)
    standings = (
        Standing(
            label,
            own[k] if k < len(own) else None,
            {name: tables[k] for name, tables in torques.items() if k < len(tables)},
        )
        for k in range(count)
    )
    return Repeated(label, tuple(standings))


def _headline(found: Ranked) -> str:
    methods, best = found.methods, found.methods[0].label
    if len(methods) == 1:
        return f"The estimates of {best} in {found.count} experiments"
    text = f"{best} is the best of {len(methods)} methods over {found.count} experiments"
    scores = [method.scores(found.judge) for method in methods]
    if {len(own) for own in scores} != {found.count}:
        return text
    wins = sum(row[0] == min(row) for row in zip(*scores, strict=True))
    return f"{text}, and predicts torques best in {wins} of them"


def _how_well(found: Ranked) -> str:
    """The medians of the best, the next and the last."""
    judge, best = found.judge, found.methods[0]
    if judge is None or not best.scores(judge):
        known = percents(best.medians(None))
        return f"Half of the parameters are known within {known} % at the median." if known else ""
    where = EXPERIMENTS.get(judge, f"the experiment {judge}")
    text = f"At the median it predicts the torques of {where} within"
    text += f" {joint_percents(best.medians(judge))} of their norm"
    rest = [(m.label, m.medians(judge)) for m in found.methods[1:] if m.scores(judge)]
    return others(text, rest)


def _belief(best: Repeated) -> str:
    """How often its verdict is good, and why it is not where it is not."""
    if not best.grades:
        return "The tables state no verdict; a CSV file cannot carry one."
    good = best.grades.count(GOOD)
    belief = BELIEF.get(best.grade, "No: the logs do not determine the parameters")
    text = f"{belief}: its verdict is good in {good} of {len(best.grades)} experiments"
    reasons = [s.reasons[0] for s in best.standings if s.grade not in ("", GOOD) and s.reasons]
    return f"{text}; elsewhere, for instance, {reasons[0]}." if reasons else f"{text}."


def _figure(found: Ranked) -> League:
    """Median and quartiles of the torque errors, or, where there are none, of the parameters'."""
    judge = found.judge
    places = []
    for number, method in enumerate(found.methods[:ROWS]):
        if judge is None or method.scores(judge):
            ranges = tuple((low, high) for low, _, high in method.quartiles(judge))
            style, middles = f"m{number}", tuple(method.medians(judge))
            places.append(Place(method.label, style, method.grade, middles, ranges))
    what, axis = "Relative standard error of the parameters", "relative standard error [%]"
    if judge is not None:
        where = EXPERIMENTS.get(judge, f"the experiment {judge}").rstrip(",")
        what = f"Error of the predicted torques of {where}"
        axis = "relative error of the predicted torque [%]"
    return League(
        caption=f"{what}: median and quartiles of {found.count} experiments; the best method "
        "first, further left is better.",
        axis=axis,
        marks=tuple(f"joint {k + 1}" for k in range(max(len(p.values) for p in places))),
        places=tuple(places),
        limit=DOUBT if judge is None else None,
    )
