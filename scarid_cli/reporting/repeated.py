"""A study over many experiments: medians and quartiles, and how often a published ranking holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import isfinite
from typing import TypeVar

import numpy as np

from scarid_cli.reporting.parts import NONE, Section, number
from scarid_cli.reporting.published import Values
from scarid_cli.reporting.results import Metrics, Parameters, Result, Trace

R = TypeVar("R", bound=Result)
BETTER_HIGH = {"r2"}


def sections(results: Sequence[Result], values: Values | None = None) -> list[Section]:
    """Results of the same name are repetitions."""
    parameters = _grouped(results, Parameters)
    traces, metrics = _grouped(results, Trace), _grouped(results, Metrics)
    found = [
        *_parameters(parameters, "Estimates", lambda r: r.estimates),
        *_parameters(parameters, "Relative standard deviations [%]", lambda r: r.deviations),
        *_traces(traces),
        *_metrics(metrics),
    ]
    counts = [len(group) for groups in (parameters, metrics) for group in groups.values()]
    count = max(counts, default=0)
    note = f"Median and quartiles of {count} experiments. "
    noted = [replace(section, note=note + section.note) for section in found]
    return [*noted, *_rankings(results, values or {})]


def _grouped(results: Sequence[Result], kind: type[R]) -> dict[tuple[str, str], list[R]]:
    """By method and experiment."""
    groups: dict[tuple[str, str], list[R]] = {}
    for result in results:
        if isinstance(result, kind):
            groups.setdefault((result.name.label, result.name.experiment), []).append(result)
    return groups


def spread(values: Sequence[float]) -> str:
    """Median, first and third quartile."""
    known = [value for value in values if isfinite(value)]
    if not known:
        return NONE
    low, middle, high = np.quantile(known, (0.25, 0.5, 0.75))
    return f"{number(float(middle))} [{number(float(low))}, {number(float(high))}]"


def _parameters(
    groups: dict[tuple[str, str], list[Parameters]],
    title: str,
    column: Callable[[Parameters], tuple[float, ...]],
) -> list[Section]:
    sections = []
    for experiment in dict.fromkeys(experiment for _, experiment in groups):
        chosen = {m: group for (m, e), group in groups.items() if e == experiment}
        first = next(iter(chosen.values()))[0]
        columns = [
            [spread(values) for values in zip(*map(column, group), strict=True)]
            for group in chosen.values()
        ]
        apriori = [number(float(x)) for x in first.robot.apriori] if first.robot else None
        keys = [first.names, first.units, *([apriori] if apriori else [])]
        sections.append(
            Section(
                title=f"{title}: {experiment}" if experiment else title,
                note="",
                headers=(*("parameter", "unit", "a priori")[: len(keys)], *chosen),
                rows=tuple(zip(*keys, *columns, strict=True)),
                texts=2,
                keys=len(keys),
            )
        )
    return sections


def _traces(groups: dict[tuple[str, str], list[Trace]]) -> list[Section]:
    if not groups:
        return []
    first = next(iter(groups.values()))[0]
    rows = tuple(
        (method, *(spread(errors) for errors in zip(*(r.errors for r in group), strict=True)))
        for (method, _), group in groups.items()
    )
    note = "Root-mean-square error of each parameter over the record (eq. 35)."
    return [Section("Errors over the record", note, ("method", *first.names), rows)]


def _metrics(groups: dict[tuple[str, str], list[Metrics]]) -> list[Section]:
    sections = []
    for experiment in dict.fromkeys(experiment for _, experiment in groups):
        chosen = {m: group for (m, e), group in groups.items() if e == experiment}
        joints = next(iter(chosen.values()))[0].joints
        rows = [
            (
                method,
                *(
                    spread([getattr(r.qualities[i], measure) for r in group])
                    for i in range(len(joints))
                    for measure in ("r2", "rmse")
                ),
            )
            for method, group in chosen.items()
        ]
        headers = [f"tau{i} {name}" for i in joints for name in ("R2", "RMSE")]
        title = f"Torque prediction: {experiment}" if experiment else "Torque prediction"
        sections.append(Section(title, "", ("method", *headers), tuple(rows), group=2))
    return sections


def _rankings(results: Sequence[Result], values: Values) -> list[Section]:
    """For each published measure of several methods: its order there, and how often it holds."""
    asked: dict[tuple[str, str, str], dict[str, float]] = {}
    for (method, experiment, quantity, measure), value in values.items():
        if measure in ("r2", "rmse", "rms_error"):
            asked.setdefault((experiment, quantity, measure), {})[method] = value
    rows = []
    for (experiment, quantity, measure), printed in asked.items():
        sign = -1.0 if measure in BETTER_HIGH else 1.0
        found = _repetitions(results, experiment, quantity, measure, list(printed))
        if not found:
            continue
        order = sorted(found[0], key=lambda method: sign * printed[method])
        orders = [sorted(order, key=lambda m, f=f: sign * f[m]) for f in found]  # type: ignore[misc]
        first = sum(o[0] == order[0] for o in orders) / len(orders)
        whole = sum(o == order for o in orders) / len(orders)
        row = (experiment or "-", quantity, measure, " < ".join(order))
        rows.append((*row, f"{100 * first:.0f} %", f"{100 * whole:.0f} %"))
    headers = ("experiment", "quantity", "measure", "published, best first", "first", "order")
    note = "How often the published best method is the best here, and the whole order the same."
    return [Section("Rankings", note, headers, tuple(rows), texts=4)] if rows else []


def _repetitions(
    results: Sequence[Result], experiment: str, quantity: str, measure: str, methods: list[str]
) -> list[dict[str, float]]:
    """The values of the methods that are there, experiment by experiment."""
    columns: dict[str, list[float]] = {method: [] for method in methods}
    for result in results:
        if result.name.label in columns:
            columns[result.name.label] += _value(result, experiment, quantity, measure)
    columns = {method: column for method, column in columns.items() if column}
    if len(columns) < 2 or len({len(column) for column in columns.values()}) > 1:
        return []
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


def _value(result: Result, experiment: str, quantity: str, measure: str) -> list[float]:
    """The value that this result has of it, if any."""
    if result.name.experiment != experiment:
        return []
    if measure == "rms_error":
        return [result.errors[result.names.index(quantity)]] if isinstance(result, Trace) else []
    if not isinstance(result, Metrics):
        return []
    at = result.joints.index(int(quantity.removeprefix("tau")))
    return [getattr(result.qualities[at], measure)]
