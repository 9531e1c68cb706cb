"""Sections on final estimates: verdict, parameters with their uncertainty (Table 2), and fit."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, nan

from scarid_cli.algorithms.statistics.verdict import DOUBT
from scarid_cli.reporting.kinds import Parameters
from scarid_cli.reporting.parts import Bars, Section, number
from scarid_cli.reporting.wording import cells, robots_of, shown, titled, with_experiment, with_unit

PLAIN = "Each estimate with its relative standard deviation in % (eq. 34)."
ROBUST = (
    "Each estimate with its relative standard deviation in % (eq. 34), and its relative standard "
    'error robust to autocorrelated residuals ("robust %").'
)


def verdicts(results: Sequence[Parameters]) -> list[Section]:
    """Whether the estimates of each method can be relied on, before anything else."""
    rows = [
        (with_experiment(r, r.name.label), r.extra["verdict"], "; ".join(r.extra["reasons"]))
        for r in results
        if "verdict" in r.extra
    ]
    if not rows:
        return []
    note = "Whether the estimates can be relied on, and why."
    headers = ("method", "verdict", "why")
    return [Section("Verdict", note, headers, tuple(rows), texts=3, keys=3, prose=True)]


def estimates(group: Sequence[Parameters], colours: dict[str, int]) -> Section:
    """Estimates of the same parameters side by side, with their uncertainty."""
    first, robust = group[0], any(r.robust for r in group)
    percents = ("%", "robust %") if robust else ("%",)
    keys = _keys(first)
    columns = [
        cells(r, values)
        for r in group
        for values in (r.estimates, r.deviations, *([_robust(r)] if robust else []))
    ]
    return Section(
        title=titled("Parameters", first.name.experiment),
        note=robots_of(group) + (ROBUST if robust else PLAIN),
        headers=(
            *("parameter", "unit", "a priori")[: len(keys)],
            *(header for name in shown(group) for header in (name, *percents)),
        ),
        rows=tuple(zip(*keys, *columns, strict=True)),
        texts=2,
        keys=len(keys),
        group=1 + len(percents),
        plots=_bars(group, colours),
    )


def _keys(result: Parameters) -> list[tuple[str, ...]]:
    """The columns before the estimates: name, unit, and a priori value where it is known."""
    keys = [result.names, result.units]
    if result.robot:
        keys.append(tuple(f"{value:.4g}" for value in result.robot.apriori))
    return keys


def _robust(result: Parameters) -> tuple[float, ...]:
    return result.robust or (nan,) * len(result.names)


def _bars(group: Sequence[Parameters], colours: dict[str, int]) -> tuple[Bars, ...]:
    """The greatest relative standard deviation of each method (Fig. 5), if any is known."""
    values = tuple(_greatest(r.deviations) for r in group)
    bars = Bars(
        caption="Largest relative standard deviation of any parameter, for each method (eq. 34). "
        f"A parameter with more than {DOUBT:g} % is doubtful.",
        axis="largest relative standard deviation [%]",
        names=tuple(shown(group)),
        values=values,
        colours=tuple(colours[r.name.label] for r in group),
        pale=tuple(r.name.published for r in group),
        doubt=DOUBT,
    )
    return (bars,) if any(map(isfinite, values)) else ()


def _greatest(values: Sequence[float]) -> float:
    return max((value for value in values if isfinite(value)), default=nan)


def fit(group: Sequence[Parameters]) -> list[Section]:
    """What the metadata say of the estimations; a CSV says nothing."""
    keys = ("condition_number", "samples", "residual_deviation", "lag_share")
    group = [r for r in group if any(key in r.extra for key in keys)]
    if not group:
        return []
    robot = group[0].robot
    units = {joint.torque_unit for joint in robot.joints} if robot else set()
    residual = with_unit("residual deviation", units.pop() if len(units) == 1 else "")
    section = Section(
        title=titled("Fit", group[0].name.experiment),
        note="Condition number of the observation matrix W, standard deviation of the residual, "
        "and lag share: the share of the residual that the motion 25 ms earlier and later "
        "explains. A lag share near 1 means that torques and derivatives are misaligned in time.",
        headers=("method", "condition number", "samples", residual, "lag share"),
        rows=tuple(
            (name, *(number(r.extra.get(key)) for key in keys))
            for name, r in zip(shown(group), group, strict=True)
        ),
    )
    return [section]
