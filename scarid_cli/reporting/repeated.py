"""A study over many experiments: medians and quartiles, and how often a published ranking holds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import TypeVar

import numpy as np

from scarid_cli.reporting.kinds import Metrics, Parameters, Result, Trace
from scarid_cli.reporting.parts import NONE, Section, number
from scarid_cli.reporting.published import Values
from scarid_cli.reporting.wording import of_kind, titled

R = TypeVar("R", bound=Result)
# The repetitions of one kind of result: by experiment, then by method.
Repetitions = Mapping[str, Mapping[str, Sequence[R]]]
BETTER_HIGH = {"r2"}
RANKING = (
    *("experiment", "quantity", "measure"),
    *("published, best first", "same best", "same order"),
)
RANKED = (
    "Share of the experiments in which the method published as the best is the best here, and in "
    "which all methods come in the published order."
)


def sections(results: Sequence[Result], values: Values | None = None) -> list[Section]:
    """Results of the same name are repetitions."""
    parameters, metrics = _repetitions(results, Parameters), _repetitions(results, Metrics)
    found = [
        *_parameters(parameters, "Estimates", lambda r: r.estimates),
        *_parameters(parameters, "Relative standard deviations [%]", lambda r: r.deviations),
        *_traces(_repetitions(results, Trace)),
        *_metrics(metrics),
    ]
    count = max(_count(parameters), _count(metrics))
    note = f"Median [first quartile, third quartile] of {count} experiments. "
    noted = [replace(section, note=note + section.note) for section in found]
    return [*noted, *_rankings(results, values or {})]


def _repetitions(results: Sequence[Result], kind: type[R]) -> Repetitions[R]:
    groups: dict[str, dict[str, list[R]]] = {}
    for result in of_kind(results, kind):
        methods = groups.setdefault(result.name.experiment, {})
        methods.setdefault(result.name.label, []).append(result)
    return groups


def _count(groups: Repetitions[R]) -> int:
    """The number of repetitions of the method that was repeated most often."""
    return max((len(group) for methods in groups.values() for group in methods.values()), default=0)


def spread(values: Sequence[float]) -> str:
    """Median, first and third quartile."""
    known = [value for value in values if isfinite(value)]
    if not known:
        return NONE
    low, middle, high = np.quantile(known, (0.25, 0.5, 0.75))
    return f"{number(float(middle))} [{number(float(low))}, {number(float(high))}]"


def _spreads(columns: Iterator[Sequence[float]]) -> list[str]:
    """The spread of each quantity; one sequence of them for each repetition."""
    return [spread(values) for values in zip(*columns, strict=True)]


def _first(methods: Mapping[str, Sequence[R]]) -> R:
    return next(iter(methods.values()))[0]


def _parameters(
    groups: Repetitions[Parameters], title: str, column: Callable[[Parameters], tuple[float, ...]]
) -> Iterator[Section]:
    for experiment, methods in groups.items():
        first = _first(methods)
        columns = [_spreads(map(column, group)) for group in methods.values()]
        apriori = [number(float(x)) for x in first.robot.apriori] if first.robot else None
        keys = [first.names, first.units, *([apriori] if apriori else [])]
        yield Section(
            title=titled(title, experiment),
            note="",
            headers=(*("parameter", "unit", "a priori")[: len(keys)], *methods),
            rows=tuple(zip(*keys, *columns, strict=True)),
            texts=2,
            keys=len(keys),
        )


def _traces(groups: Repetitions[Trace]) -> Iterator[Section]:
    for experiment, methods in groups.items():
        rows = ((m, *_spreads(r.errors for r in group)) for m, group in methods.items())
        yield Section(
            title=titled("Errors of the running estimates", experiment),
            note="Root-mean-square error of each running estimate with respect to its a priori "
            "value, over the whole record (eq. 35).",
            headers=("method", *_first(methods).names),
            rows=tuple(rows),
        )


def _metrics(groups: Repetitions[Metrics]) -> Iterator[Section]:
    for experiment, methods in groups.items():
        joints = _first(methods).joints
        rows = (
            (method, *_spreads([x for q in r.qualities for x in (q.r2, q.rmse)] for r in group))
            for method, group in methods.items()
        )
        headers = (f"tau{i} {name}" for i in joints for name in ("R2", "RMSE"))
        title = titled("Torque prediction", experiment)
        yield Section(title, "", ("method", *headers), tuple(rows), group=2)


def _rankings(results: Sequence[Result], values: Values) -> list[Section]:
    """How often the published order of the methods holds, for each measure that was published."""
    rows = []
    for (experiment, quantity, measure), published in _published(values).items():
        found = _values(results, experiment, quantity, measure, list(published))
        if not found:
            continue
        sign = -1.0 if measure in BETTER_HIGH else 1.0
        orders = [sorted(x, key=lambda method, x=x: sign * x[method]) for x in found]  # type: ignore[misc]
        order = sorted(found[0], key=lambda method: sign * published[method])
        best = _share([o[0] == order[0] for o in orders])
        whole = _share([o == order for o in orders])
        rows.append((experiment or NONE, quantity, measure, " < ".join(order), best, whole))
    return [Section("Rankings", RANKED, RANKING, tuple(rows), texts=4)] if rows else []


def _share(cases: Sequence[bool]) -> str:
    return f"{100 * (sum(cases) / len(cases)):.0f} %"


def _published(values: Values) -> dict[tuple[str, str, str], dict[str, float]]:
    """Values by method for each experiment, quantity and measure that ranks methods."""
    ranked: dict[tuple[str, str, str], dict[str, float]] = {}
    for (method, experiment, quantity, measure), value in values.items():
        if measure in ("r2", "rmse", "rms_error"):
            ranked.setdefault((experiment, quantity, measure), {})[method] = value
    return ranked


def _values(
    results: Sequence[Result], experiment: str, quantity: str, measure: str, methods: list[str]
) -> list[dict[str, float]]:
    """Repetition by repetition, the value of each of these methods that has any."""
    columns: dict[str, list[float]] = {method: [] for method in methods}
    for result in results:
        if result.name.label in columns:
            columns[result.name.label] += _value(result, experiment, quantity, measure)
    columns = {method: column for method, column in columns.items() if column}
    if len(columns) < 2 or len({len(column) for column in columns.values()}) > 1:
        return []
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _value(result: Result, experiment: str, quantity: str, measure: str) -> list[float]:
    """The value of this measure in this result; empty if it has none."""
    if result.name.experiment != experiment:
        return []
    if measure == "rms_error":
        return [result.errors[result.names.index(quantity)]] if isinstance(result, Trace) else []
    if not isinstance(result, Metrics):
        return []
    at = result.joints.index(int(quantity.removeprefix("tau")))
    return [getattr(result.qualities[at], measure)]
