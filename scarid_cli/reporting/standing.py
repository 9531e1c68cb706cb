"""The methods of a report from the best to the worst, and what their order rests on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, inf, isfinite, log, sqrt

from scarid_cli.algorithms.statistics.verdict import DOUBTFUL, GOOD, NOT_IDENTIFIABLE
from scarid_cli.reporting.kinds import Metrics, Parameters, Result
from scarid_cli.reporting.wording import experiment_of, of_kind

# The experiments that compare methods best: one motion for all, then a log of its own.
JUDGES = ("common", "cross")
GRADES = (GOOD, DOUBTFUL, NOT_IDENTIFIABLE)
LEAST = 1e-12  # of 1 - R2: the rounding of a simulation without noise


@dataclass(frozen=True)
class Standing:
    """What is known of a method: its estimates, its quality in the judging experiment, or both."""

    label: str
    parameters: Parameters | None
    metrics: Metrics | None

    @property
    def verdict(self) -> str:
        """The verdict of identify; empty where the table states none."""
        return str(self.parameters.extra.get("verdict", "")) if self.parameters else ""

    @property
    def reasons(self) -> tuple[str, ...]:
        return tuple(self.parameters.extra.get("reasons", ())) if self.parameters else ()

    @property
    def r2(self) -> tuple[float, ...]:
        return tuple(q.r2 for q in self.metrics.qualities) if self.metrics else ()

    @property
    def error(self) -> float:
        """The geometric mean over the joints of the relative error; infinite where unknown."""
        known = [sqrt(max(1.0 - r2, LEAST)) for r2 in self.r2 if isfinite(r2)]
        return exp(sum(map(log, known)) / len(known)) if known else inf


def standings(results: Sequence[Result]) -> list[Standing]:
    """Every method with estimates or a quality: by verdict, then by its errors of prediction."""
    own = [r for r in results if not r.name.published]
    estimated = of_kind(own, Parameters)
    first = estimated[0].name.experiment if estimated else ""
    parameters = {r.name.label: r for r in estimated if r.name.experiment == first}
    judge = judging(own)
    metrics = {r.name.label: r for r in of_kind(own, Metrics) if experiment_of(r) == judge}
    labels = dict.fromkeys([*parameters, *metrics])
    found = [Standing(name, parameters.get(name), metrics.get(name)) for name in labels]
    return sorted(found, key=lambda one: (_grade(one), one.error))


def _grade(standing: Standing) -> int:
    return GRADES.index(standing.verdict) if standing.verdict in GRADES else len(GRADES)


def judging(results: Sequence[Result]) -> str:
    """The experiment that decides the order: `common`, else `cross`, else the last one."""
    names = [experiment_of(r) for r in of_kind(results, Metrics) if not r.name.published]
    return next((name for name in JUDGES if name in names), names[-1] if names else "")
