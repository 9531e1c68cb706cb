"""Sections on predicted torques: all experiments (Tables 4 and 5), and each one (Figs. 7 and 8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite

from scarid_cli.reporting.kinds import Metrics, Prediction
from scarid_cli.reporting.parts import NONE, Panel, Panels, Section, Series, number, pages
from scarid_cli.reporting.wording import (
    cells,
    common_unit,
    experiment_of,
    of_kind,
    robots_of,
    shown,
    titled,
    with_experiment,
    with_unit,
)

COMPARED = (0, 1)  # the figures of a joint that stand beside those of other experiments: R2, RMSE


def experiments(results: Sequence[Metrics]) -> list[Section]:
    """All experiments side by side, where there are several with the same joints."""
    first = results[0] if results else None
    names = list(dict.fromkeys(map(experiment_of, results)))
    if not first or len(names) < 2 or any(r.joints != first.joints for r in results):
        return []
    joints, units = range(len(first.joints)), _units(results)
    headers = _headers(first.joints, units)
    at = [(name, 3 * i + figure) for figure in COMPARED for name in names for i in joints]
    by_name = {(r.name.shown, experiment_of(r)): _figures(r, units) for r in results}
    nothing = [NONE] * len(headers)
    section = Section(
        title="Torque prediction",
        note=f"{robots_of(results)}Coefficient of determination R2 (eq. 36) and root-mean-square "
        "error (eq. 35) of the predicted torques in each experiment.",
        headers=("method", *(f"{name}: {headers[k]}" if name else headers[k] for name, k in at)),
        rows=tuple(
            (method, *(by_name.get((method, name), nothing)[k] for name, k in at))
            for method in dict.fromkeys(shown(results))
        ),
        group=len(names) * len(joints),
    )
    return [section]


def experiment(group: Sequence[Metrics | Prediction], colours: dict[str, int]) -> Section:
    """One experiment: quality of the predicted torques, and the torques themselves."""
    metrics = of_kind(group, Metrics)
    title = titled("Torque prediction", group[0].name.experiment)
    section = Section(title, note="", plots=_plots(of_kind(group, Prediction), colours))
    if not metrics:
        return section
    units = _units(metrics)
    return replace(
        section,
        note=f"{robots_of(metrics)}For each joint: coefficient of determination R2 (eq. 36), "
        "root-mean-square error (eq. 35), and norm of the error relative to that of the torque "
        "in %.",
        headers=("method", "samples", *_headers(metrics[0].joints, units)),
        rows=tuple(
            (name, _samples(r), *_figures(r, units))
            for name, r in zip(shown(metrics), metrics, strict=True)
        ),
        keys=2,
        group=3,
    )


def _units(results: Sequence[Metrics]) -> list[str]:
    """The unit of each joint's torque; empty if the results differ in it."""
    return [common_unit(units) for units in zip(*(r.units for r in results), strict=True)]


def _headers(joints: Sequence[int], units: Sequence[str]) -> list[str]:
    return [
        header
        for joint, unit in zip(joints, units, strict=True)
        for header in (
            f"tau{joint} R2",
            with_unit(f"tau{joint} RMSE", unit),
            f"tau{joint} error [%]",
        )
    ]


def _figures(result: Metrics, units: Sequence[str]) -> list[str]:
    """R2, RMSE and relative error of each joint; a unit that differs stands in the cell."""
    return [
        cell
        for q, own, unit in zip(result.qualities, result.units, units, strict=True)
        for cell in (
            f"{q.r2:.4f}" if isfinite(q.r2) else NONE,
            cells(result, [q.rmse])[0] + ("" if unit else f" {own}"),
            number(q.relative_error),
        )
    ]


def _samples(result: Metrics) -> str:
    """All joints of a motion have the same number, unless slow rows were left out."""
    counts = [q.samples for q in result.qualities]
    least, most = number(min(counts) or None), number(max(counts) or None)
    return least if least == most else f"{least} to {most}"


def _plots(results: Sequence[Prediction], colours: dict[str, int]) -> tuple[Panels, ...]:
    return tuple(
        Panels(f"Actual and predicted torques: {with_experiment(r, name)}.", part, columns=1)
        for name, r in zip(shown(results), results, strict=True)
        for part in pages(_panels(r, name, colours[r.name.label]))
    )


def _panels(result: Prediction, name: str, colour: int) -> list[Panel]:
    curves = zip(result.joints, result.units, result.measured, result.predicted, strict=True)
    return [
        Panel(
            with_unit(f"tau{joint}", unit),
            (Series("actual", None, actual), Series(f"predicted, {name}", colour, predicted)),
        )
        for joint, unit, actual, predicted in curves
    ]
