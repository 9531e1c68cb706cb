"""Which method is best, by how much, and whether it may be believed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, isfinite, log

from scarid_cli.algorithms.inference.verdict import GRADES
from scarid_cli.reporting.kinds import Metrics, Parameters, Result
from scarid_cli.reporting.naming import COMMON
from scarid_cli.reporting.said import Said, named, same_table
from scarid_cli.reporting.wording import experiment_of, of_kind

# Experiments by how fair a judge of methods they are: one motion for all, then another log than
# that of the identification. Those of other names come between.
FAIREST, FAIR, UNFAIR = COMMON, "cross", ("direct", "")


@dataclass(frozen=True)
class Standing:
    """One method: its parameters, if they are known, and the torques it predicts by experiment."""

    label: str
    parameters: Parameters | None
    metrics: dict[str, Metrics]

    @property
    def name(self) -> str:
        """The method, with the experiment of its parameters if they have one."""
        experiment = self.parameters.name.experiment if self.parameters else ""
        return f"{self.label}, {experiment}" if experiment else self.label

    @property
    def grade(self) -> str:
        return str(self.parameters.extra.get("verdict", "")) if self.parameters else ""

    @property
    def reasons(self) -> tuple[str, ...]:
        return tuple(self.parameters.extra.get("reasons", ())) if self.parameters else ()

    @property
    def said(self) -> tuple[Said, ...]:
        """What validate has said of the robot."""
        return tuple(one.said for one in self.metrics.values() if one.said)

    def errors(self, experiment: str) -> tuple[float, ...]:
        """The relative error of each predicted torque [%]; empty if there are none."""
        found = self.metrics.get(experiment)
        return tuple(q.relative_error for q in found.qualities) if found else ()

    def score(self, experiment: str) -> float:
        """The geometric mean of the relative errors of the joints [%]; inf if unknown."""
        known = [e for e in self.errors(experiment) if isfinite(e) and e > 0.0]
        return exp(sum(map(log, known)) / len(known)) if known else inf

    def vagueness(self) -> float:
        """The median relative standard error of the parameters [%]; inf if unknown."""
        if not self.parameters:
            return inf
        errors = self.parameters.robust or self.parameters.deviations
        known = sorted(e for e in errors if isfinite(e))
        return known[len(known) // 2] if known else inf


@dataclass(frozen=True)
class Ranking:
    """The methods, the best first, and the experiment whose torques decided ("" may be one)."""

    standings: tuple[Standing, ...]
    judge: str | None

    @property
    def best(self) -> Standing:
        return self.standings[0]

    @property
    def identified(self) -> tuple[Standing, ...]:
        """The methods whose parameters are here; all if none are."""
        return tuple(s for s in self.standings if s.parameters) or self.standings

    def places(self) -> dict[str, int]:
        """The place of each label, from 0."""
        labels = dict.fromkeys(standing.label for standing in self.standings)
        return {label: place for place, label in enumerate(labels)}


def ranking(results: Sequence[Result]) -> Ranking | None:
    """The methods in order: by verdict, then by predicted torques, then by stated errors."""
    own = [r for r in results if not r.name.published]
    standings = _standings(of_kind(own, Parameters), of_kind(own, Metrics))
    if not standings:
        return None
    judge = judge_of(of_kind(own, Metrics))

    def key(standing: Standing) -> tuple[int, float, float]:
        grade = GRADES.index(standing.grade) if standing.grade in GRADES else len(GRADES)
        return grade, standing.score(judge) if judge is not None else inf, standing.vagueness()

    return Ranking(tuple(sorted(standings, key=key)), judge)


def _standings(parameters: Sequence[Parameters], metrics: Sequence[Metrics]) -> list[Standing]:
    """Metrics belong to the parameters that predicted them, as their history tells.

    Without a history they belong to the parameters of their label, the first ones if there are
    several; beside the parameters of one label, metrics of one other label are of these.
    """
    files = {each.file: each.name.label for each in parameters}
    by_label: dict[str, dict[str, Metrics]] = {}
    for one in metrics:
        by_label.setdefault(_owner(one, files), {})[experiment_of(one)] = one
    labels = {each.name.label for each in parameters}
    unstated = all(not one.by for one in metrics)
    if unstated and len(labels) == len(by_label) == 1:
        by_label = {labels.pop(): by_label.popitem()[1]}
    found = [
        Standing(each.name.label, each, by_label.pop(each.name.label, {}))
        for each in sorted(parameters, key=lambda r: r.name.experiment != "")
    ]
    return [*found, *(Standing(label, None, those) for label, those in by_label.items())]


def _owner(metrics: Metrics, files: dict[str, str]) -> str:
    """The label of the parameters that predicted the torques."""
    if not metrics.by:
        return metrics.name.label
    known = [label for file, label in files.items() if same_table(file, metrics.by[0])]
    if len(metrics.by) == 1 and known:
        return known[0]
    own = metrics.name.label
    return own if own not in files.values() else f"{own}, predicted by {named(metrics.by)}"


def judge_of(metrics: Sequence[Metrics]) -> str | None:
    """The experiment in which most methods can be compared, the fairest of these."""
    counts: dict[str, int] = {}
    for one in metrics:
        counts[experiment_of(one)] = counts.get(experiment_of(one), 0) + 1
    if not counts:
        return None
    most = max(counts.values())
    return min((name for name, count in counts.items() if 2 * count > most), key=_unfairness)


def _unfairness(experiment: str) -> int:
    if experiment in UNFAIR:
        return 3 + UNFAIR.index(experiment)
    return {FAIREST: 0, FAIR: 1}.get(experiment, 2)
