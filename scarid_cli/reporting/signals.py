"""Sections on signals: the logs (Fig. 3), and derivatives estimated from them (Fig. 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from scarid_cli.reporting.kinds import Measurement, MotionEstimate
from scarid_cli.reporting.parts import Panel, Panels, Section, Series, number
from scarid_cli.reporting.wording import titled

ZOOM = (0.5, 0.575)  # of a record: a second and a half of twenty
MARGIN = 0.3  # of the range of the true signal, beyond which a panel clips an estimate


def logs(group: Sequence[Measurement]) -> Section:
    """Logs of one experiment beside each other, and how well the robot tracked the reference."""
    first = group[0]
    followed = [r for r in group if r.tracking]
    headers = [f"q{i + 1} [{_position_unit(first, i)}]" for i in range(len(first.positions))]
    plots = []
    if first.torques:
        plots.append(Panels("Torques of each log.", _torques(group), columns=1))
    if followed:
        plots.append(Panels("Positions and their references.", _tracking(followed), columns=1))
    return Section(
        title=titled("Logs", first.name.experiment),
        note="Tracking error: root-mean-square difference between position and reference."
        if followed
        else "",
        headers=("log", *headers) if followed else (),
        rows=tuple((r.name.label, *map(number, r.tracking)) for r in followed),
        plots=tuple(plots),
    )


def _torques(group: Sequence[Measurement]) -> tuple[Panel, ...]:
    """The first log is drawn wide and pale, below the others."""
    return tuple(
        Panel(
            f"tau{i + 1} [{_torque_unit(group[0], i)}]",
            tuple(
                Series(r.name.label, k - 1 if k else None, r.torques[i])
                for k, r in enumerate(group)
                if r.torques
            ),
        )
        for i in range(len(group[0].torques))
    )


def _tracking(group: Sequence[Measurement]) -> tuple[Panel, ...]:
    return tuple(
        Panel(
            f"q{i + 1} [{_position_unit(group[0], i)}]",
            (
                Series("reference", None, group[0].references[i]),
                *(Series(r.name.label, k, r.positions[i]) for k, r in enumerate(group)),
            ),
        )
        for i in range(len(group[0].positions))
    )


def _torque_unit(result: Measurement, joint: int) -> str:
    return result.robot.joints[joint].torque_unit if result.robot else "N m"


def _position_unit(result: Measurement | MotionEstimate, joint: int) -> str:
    return result.robot.joints[joint].unit if result.robot else "rad"


def compared_with(result: MotionEstimate) -> tuple[str, str]:
    """The experiment, and what stands for the truth: such estimates share a section."""
    return result.name.experiment, result.against


def soft_sensors(group: Sequence[MotionEstimate], colours: dict[str, int]) -> Section:
    """Velocities and accelerations of one experiment, method by method, with an enlarged part."""
    first = group[0]
    whole = [_estimates(group, colours, i) for i in range(len(first.columns))]
    end = first.curves[0][0, -1]
    enlarged = [_between(panel, ZOOM[0] * end, ZOOM[1] * end) for panel in whole]
    known = [r for r in group if r.errors]
    return Section(
        title=titled("Soft sensors", first.name.experiment),
        note=f"Root-mean-square difference from the {first.against}, relative to the standard "
        "deviation of the latter, in %, without settling rows. Both are compared at the same "
        "instant, so a delay counts as an error."
        if known
        else "",
        headers=("method", *(f"{column} [%]" for column in first.columns)) if known else (),
        rows=tuple((r.name.label, *map(number, r.errors)) for r in known),
        plots=(
            Panels("Estimated velocities and accelerations.", tuple(whole), columns=1),
            Panels("The same, enlarged: a short part of the record.", tuple(enlarged), columns=1),
        ),
    )


def _estimates(group: Sequence[MotionEstimate], colours: dict[str, int], i: int) -> Panel:
    first = group[0]
    column = first.columns[i]
    unit = _position_unit(first, int(column.lstrip("dq")) - 1)
    series = [Series(r.name.label, colours[r.name.label], r.curves[i]) for r in group]
    limits = None
    if first.truths:
        name = "true" if first.against == "truth" else first.against
        series.insert(0, Series(name, None, first.truths[i]))
        low, high = (float(f(first.truths[i][1])) for f in (np.min, np.max))
        limits = (low - MARGIN * (high - low), high + MARGIN * (high - low))
    per_time = "/s2" if column.startswith("ddq") else "/s"
    return Panel(f"{column} [{unit}{per_time}]", tuple(series), limits=limits)


def _between(panel: Panel, start: float, end: float) -> Panel:
    """The same panel between two times [s]."""
    kept = (
        replace(series, points=series.points[:, (start <= t) & (t <= end)])
        for series in panel.series
        for t in [series.points[0]]
    )
    return replace(panel, series=tuple(kept))
