"""Sections on final estimates: verdict, parameters with their uncertainty (Table 2), and fit."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, nan

from scarid_cli.algorithms.inference.verdict import DOUBT
from scarid_cli.interval import plus_minus
from scarid_cli.reporting.kinds import Comparison, Metrics, Parameters, Result
from scarid_cli.reporting.parts import Bars, Section, number
from scarid_cli.reporting.said import ALARMING, FINE, Said
from scarid_cli.reporting.wording import (
    cells,
    of_kind,
    robots_of,
    shown,
    titled,
    with_experiment,
    with_unit,
)

PLAIN = "Each estimate with its relative standard deviation in % (eq. 34)."
ROBUST = (
    "Each estimate with its relative standard deviation in % (eq. 34), and its relative standard "
    'error robust to autocorrelated residuals ("robust %").'
)

VAGUE = 100.0  # %: a percentage of an estimate that may be zero says nothing
NEAR_ZERO = (
    f" Above {VAGUE:g} % stands half the 95 % interval instead (+-), in the parameter's unit."
)


def verdicts(results: Sequence[Parameters]) -> list[Section]:
    """Whether the estimates of each method can be relied on, before anything else."""
    rows = [
        (with_experiment(r, r.name.label), r.extra["verdict"], "; ".join(r.extra["reasons"]))
        for r in results
        if "verdict" in r.extra
    ]
    note = "Whether the estimates can be relied on, and why."
    return _prose("Verdict", note, ("method", "verdict", "why"), rows)


def changes(said: Sequence[Said]) -> list[Section]:
    """Whether the robot has changed, by validate and compare; the alarming verdicts first."""
    order = sorted(said, key=lambda one: (*ALARMING, *FINE).index(one.verdict))
    rows = [(one.title, one.verdict, one.reason) for one in order]
    note = "Whether the robot is the one that was identified, by validate and compare."
    return _prose("Has the robot changed?", note, ("log or table", "verdict", "why"), rows)


def said_of(results: Sequence[Result]) -> list[Said]:
    """All that validate and compare have said."""
    found = [r.said for r in of_kind(results, Metrics) if r.said]
    return [*found, *(one for r in of_kind(results, Comparison) for one in r.said)]


def _prose(
    title: str, note: str, headers: tuple[str, ...], rows: Sequence[tuple[str, ...]]
) -> list[Section]:
    """A section whose last column is running text; none without rows."""
    if not rows:
        return []
    return [Section(title, note, headers, tuple(rows), texts=3, keys=3, prose=True)]


def estimates(group: Sequence[Parameters], colours: dict[str, int]) -> Section:
    """Estimates of the same parameters side by side, with their uncertainty."""
    first, robust = group[0], any(r.robust for r in group)
    percents = ("%", "robust %") if robust else ("%",)
    vague = any(x > VAGUE for r in group for x in (*r.deviations, *_robust(r)))
    keys = _keys(first)
    columns = [
        values
        for r in group
        for values in (
            cells(r, r.estimates),
            _relative(r, r.deviations),
            *([_relative(r, _robust(r))] if robust else []),
        )
    ]
    return Section(
        title=titled("Parameters", first.name.experiment),
        note=robots_of(group) + (ROBUST if robust else PLAIN) + (NEAR_ZERO if vague else ""),
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


def _relative(result: Parameters, percents: Sequence[float]) -> list[str]:
    """Percentages of the estimates; half the 95 % interval where the estimate may be zero."""
    texts = zip(cells(result, percents), percents, result.estimates, strict=True)
    return [
        plus_minus(abs(estimate) * percent / 100.0) if percent > VAGUE else text
        for text, percent, estimate in texts
    ]


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
    keys = ("condition_number", "samples", "residual_deviation")
    group = [r for r in group if any(key in r.extra for key in keys)]
    if not group:
        return []
    robot = group[0].robot
    units = {joint.torque_unit for joint in robot.joints} if robot else set()
    residual = with_unit("residual deviation", units.pop() if len(units) == 1 else "")
    section = Section(
        title=titled("Fit", group[0].name.experiment),
        note="Condition number of the observation matrix W, and standard deviation of the "
        "residual.",
        headers=("method", "condition number", "samples", residual),
        rows=tuple(
            (name, *(number(r.extra.get(key)) for key in keys))
            for name, r in zip(shown(group), group, strict=True)
        ),
    )
    return [section]


def constants(group: Sequence[Parameters]) -> list[Section]:
    """Which estimates depend on the torque constant of which joint, of the first such table."""
    found = next((r for r in group if r.extra.get("torque_constants")), None)
    if found is None:
        return []
    moves = found.extra["torque_constants"]
    estimates = dict(zip(found.names, found.estimates, strict=True))
    joints = len(next(iter(moves.values())))
    section = Section(
        title=titled("Torque constants", found.name.experiment),
        note="By how many percent an estimate is too large if the torque constant of a joint is "
        "1 % too large. A log shows how constants differ, and never the factor that all have in "
        "common: state it with identify --torque-gain-error, or weigh a load with scarid gains.",
        headers=("parameter", *(f"joint {i}" for i in range(1, joints + 1))),
        rows=tuple(
            (name, *(number(_ratio(x, estimates[name])) for x in row))
            for name, row in moves.items()
            if name in estimates
        ),
    )
    return [section]


def _ratio(moved: float, estimate: float) -> float:
    return moved / estimate if estimate else nan
