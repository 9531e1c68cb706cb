"""The blind procedure: from logs to parameters and a verdict, with nothing that has to be chosen.

`identified` is the whole of it. It is `prepared`, from the logs to the motion that is fitted, and
then `estimated`; a command calls the two parts, and reports between them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from scarid_cli.algorithms.choices.registry import ESTIMATORS
from scarid_cli.algorithms.regression.counting import Counting
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.schemas import numbered
from scarid_cli.io.table import SEGMENT, Metadata, Table, only
from scarid_cli.stages.identify import identify

if TYPE_CHECKING:  # scipy is needed for measurements only
    from scarid_cli.stages.procedure.recommended import Progress, Smoothed
    from scarid_cli.stages.records.slower import Slower

FOR_MOTION, FOR_MEASUREMENT = "rls", "gls"  # the estimator if none is chosen
NOISIER = 1.5  # times the noise of the velocities at identification, known to a few percent


@dataclass(frozen=True)
class Choices:
    """What is chosen beforehand; the procedure chooses what is None.

    `bandwidth` [Hz] is that of a motion which does not state it, and `all_rows` keeps the rows that
    do not count. Whether the torques are aligned is `align`, not that of the `treatment`.
    """

    estimator: str | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    align: bool | None = None
    treatment: Treatment = field(default_factory=Treatment)
    bandwidth: float | None = None
    all_rows: bool = False

    def of_motion(self) -> Chosen:
        """What is used with a motion."""
        name = self.estimator or FOR_MOTION
        method = ESTIMATORS.load(name)
        return Chosen(name, method, replace(self.treatment, align=bool(self.align)))

    def of_measurement(self) -> Chosen:
        """What is used with a measurement: torques are aligned wherever they can be."""
        name = self.estimator or (FOR_MOTION if self.settings else FOR_MEASUREMENT)
        method = ESTIMATORS.load(name)
        align = bool(method.ALIGNS) if self.align is None else self.align
        return Chosen(name, method, replace(self.treatment, align=align))


@dataclass(frozen=True)
class Chosen:
    """An estimator, and how it takes the rows."""

    name: str
    method: Any
    treatment: Treatment


@dataclass(frozen=True)
class Prepared:
    """The motion that is fitted, what it is fitted by, and how the motion was found.

    `slower` are the groups of each log whose readings were interpolated. A motion that was given is
    not `smoothed`.
    """

    motion: Table
    chosen: Chosen
    slower: Sequence[Sequence[Slower]]
    smoothed: Smoothed | None


@dataclass(frozen=True)
class Passed:
    """What the positions passed at an identification: the bandwidth [Hz], and what noise was left.

    `noise` is that of the velocities [rad/s or m/s], inf if it is not known.
    """

    hertz: float
    noise: float = inf

    @classmethod
    def of(cls, tables: Sequence[Table]) -> Passed | None:
        """The lowest bandwidth of these parameters, and the largest noise; None if none has one."""
        facts = [table.meta.extra for table in tables if table.meta.extra.get("bandwidth")]
        if not facts:
            return None
        noise = [max(fact.get("velocity_noise") or [inf]) for fact in facts]
        return cls(min(float(fact["bandwidth"]) for fact in facts), max(noise))

    def quieter(self, motion: Table) -> bool:
        """Whether this motion, behind the same low-pass, is clearly noisier."""
        noise = float(max(motion.meta.extra.get("velocity_noise") or [0.0]))
        return noise > NOISIER * self.noise


def identified(
    logs: Sequence[Table],
    robot: Robot,
    choices: Choices | None = None,
    *,
    progress: Progress | None = None,
    **further: Any,
) -> Table:
    """The table of parameters of a robot, from its logs (measurements or motions).

    `further` is as for `stages.identify`.
    """
    choices = choices or Choices()
    found = prepared(logs, robot, choices, progress=progress)
    return estimated(found, robot, choices.settings, **further)


def prepared(
    logs: Sequence[Table],
    robot: Robot,
    choices: Choices,
    *,
    progress: Progress | None = None,
    before: Passed | None = None,
) -> Prepared:
    """The motion of all logs, and what it is fitted by.

    `progress` opens a line that shows the search for the bandwidth. This is that of the
    identification `before`; it is searched if that is not known, or if it lets through more noise
    than then.
    """
    chosen = choices.of_motion()
    follows = chosen.method.FOLLOWS
    even = [(log, []) if follows or is_motion(log) else evened(log) for log in logs]
    motion, slower = _one([log for log, _ in even]), [groups for _, groups in even]
    smoothed = None
    if not (follows or is_motion(motion)):
        from scarid_cli.stages.procedure.recommended import smoothed_motion

        chosen = choices.of_measurement()
        smoothed = smoothed_motion(motion, robot, progress, before)
        motion = smoothed.motion
    all_rows = choices.all_rows or chosen.method.FOLLOWS
    counting = None if all_rows else counted(motion.meta, choices.bandwidth)
    treatment = replace(chosen.treatment, counting=counting)
    return Prepared(motion, replace(chosen, treatment=treatment), slower, smoothed)


def estimated(
    found: Prepared,
    robot: Robot,
    settings: Mapping[str, Any],
    initial: Array | None = None,
    **further: Any,
) -> Table:
    """The table of parameters of a prepared motion; `further` is as for `stages.identify`."""
    if found.smoothed:  # what makes the result wrong enters the verdict
        further.setdefault("findings", []).extend(found.smoothed.failed)
    solver = found.chosen.method(**settings)
    start = np.zeros(len(robot.names)) if initial is None else initial
    return identify(found.motion, robot, solver, start, treatment=found.chosen.treatment, **further)


def needed(log: Table, *, reference: bool) -> Table:
    """A measurement without the columns that no step of the procedure reads.

    It is held in memory. The estimator may read the `reference`.
    """
    if is_motion(log):
        return log
    names = {"t", SEGMENT, *numbered(log.columns, "q", "dq", "tau")}
    ends = ("_measured", "_ref") if reference else ("_measured",)
    return only(log, [c for c in log.columns if c in names or c.endswith(ends)])


def is_motion(table: Table) -> bool:
    """Whether the table has accelerations."""
    return bool(numbered(table.columns, "ddq"))


def counted(motion: Metadata, bandwidth: float | None) -> Counting:
    """Which rows of a motion count; the `bandwidth` [Hz] is stated for a motion without its own."""
    noise = tuple(motion.extra.get("velocity_noise") or ())
    return Counting(bandwidth or motion.extra.get("bandwidth"), noise)


def evened(measurement: Table) -> tuple[Table, list[Slower]]:
    """The measurement without steps between the readings of slower sensors, and these sensors.

    It is then as `resample` returns it, at the rate that it has.
    """
    from scarid_cli.stages.records.slower import slower_groups
    from scarid_cli.stages.resample import resample

    slower, measurement = slower_groups(measurement)
    even = resample(measurement, float(rate_of(measurement))) if slower else measurement
    return even, slower


def rate_of(measurement: Table) -> str:
    """The rate [Hz] of a log, as it is typed."""
    return f"{1.0 / measurement.period:.12g}"


def _one(logs: Sequence[Table]) -> Table:
    """The logs as the segments of one; a single log stays as it is."""
    if len(logs) == 1:
        return logs[0]
    from scarid_cli.stages.records.several import joined

    return joined(logs)
