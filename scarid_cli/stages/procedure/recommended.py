"""The recommended way from a measurement to a motion, with nothing to choose."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from scarid_cli.algorithms.checks.finding import FAILED, Finding
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.lowpassed import TWO_SIDED
from scarid_cli.errors import TooShort
from scarid_cli.io.table import Table
from scarid_cli.stages.differentiate import matched
from scarid_cli.stages.procedure.bandwidth import bandwidth, recommended, smoother_at
from scarid_cli.stages.records.compact import Compact
from scarid_cli.stages.records.record import Record
from scarid_cli.stages.remarks.glance import explained, in_seconds, of_extremes, of_measurement

if TYPE_CHECKING:
    from scarid_cli.stages.procedure.blind import Passed

Step = Callable[[], object]
Progress = Callable[[], AbstractContextManager[Step]]

# Checks without which derivatives or torques are not those of the joints.
SPOILING = ("wraps", "glitches", "clock", "equal positions", "saturation")


@dataclass(frozen=True)
class Smoothed:
    """The motion of a measurement, its smoother, and why this one.

    `findings` are what is not in order with the measurement, `left_out` the reason for each segment
    that was left out, and `noise` [rad or m] that of the positions.
    """

    motion: Table
    smoother: Any
    text: str
    cutoff: float
    noise: float
    left_out: list[TooShort]
    findings: list[Finding]

    @property
    def failed(self) -> list[Finding]:
        """Those of the findings that make any result wrong."""
        return [one for one in self.findings if one.name in SPOILING and one.status == FAILED]


def smoothed_motion(
    measurement: Table, robot: Robot, progress: Progress | None = None, before: Passed | None = None
) -> Smoothed:
    """The motion of a measurement, behind the smoother at which the parameters scatter least.

    The measurement is held in memory. The smoother is that of the identification `before`, unless
    this lets through more noise than then and the parameters scatter least behind a stronger one.
    """
    compact = Compact.of(measurement, len(robot.joints))
    findings = of_measurement(compact)
    held = Record(tuple(compact.segments), compact.joints, measurement.period, measurement.name)

    def motion(smoother: Any, text: str, cutoff: float, noise: float) -> Smoothed:
        left_out: list[TooShort] = []
        found = matched(compact.table, [smoother] * held.joints, left_out)
        return Smoothed(found, smoother, text, cutoff, noise, left_out, findings)

    seen = partial(_unusual, compact, robot, findings)
    with (progress or _unseen)() as step, in_seconds(measurement), explained(held.name, seen):
        if before:
            cutoff = before.hertz / TWO_SIDED
            smoother = smoother_at(held, cutoff)
            text = f"cut-off {cutoff:.3g} Hz for all joints, as at the identification"
            same = motion(smoother, text, cutoff, smoother.noise)
            if not before.quieter(same.motion):
                return same
        found = bandwidth(held, robot, step)
        if before and not found.cutoff < cutoff:
            return same
        text = found.text
        text += ", and positions are noisier than at the identification" if before else ""
        smoother = recommended(found, measurement.period)
        return motion(smoother, text, found.cutoff, found.noise)


def _unusual(held: Compact, robot: Robot, findings: list[Finding]) -> list[Finding]:
    """What may be the reason why a measurement cannot be smoothed: leaps before their extremes."""
    if any(finding.status == FAILED for finding in findings):
        return findings
    ends = np.column_stack((held.values.min(axis=1), held.values.max(axis=1)))[1:]
    q, tau = ends[: held.joints], ends[held.joints :]
    return of_extremes(q, tau, robot, held.source.period)


@contextlib.contextmanager
def _unseen() -> Iterator[Step]:
    yield lambda: None
