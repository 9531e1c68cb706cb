"""How far positions and torques reach that stream through: `identify` tells of wrong units.

The checks themselves are imported only where something is out of the usual, so that they do not
delay the start of a run in which nothing is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import pi

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.checks.finding import Finding
from scarid_cli.algorithms.choices.settings import LONGEST
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, settled

FARTHEST = 4.0 * pi  # rad, of a usual joint without limits
LEAST = 0.003  # of the torque limit, which a usual log exceeds at some joint (units.IDLE)


@dataclass
class Reach:
    """The least and the greatest positions and torques (2 joints) of the settled rows."""

    joints: int
    low: Array = field(init=False)
    high: Array = field(init=False)

    def __post_init__(self) -> None:
        self.low = np.full(2 * self.joints, np.inf)
        self.high = -self.low

    def watched(self, table: Table) -> Table:
        """The table, whose rows are watched; one without positions is left alone."""
        names = of_joints(self.joints, "q{i}", "tau{i}")
        if not set(names) <= set(table.columns):
            return table
        return replace(table, batches=self._watched(table.batches, names))

    def _watched(
        self, batches: Iterator[pa.RecordBatch], names: list[str]
    ) -> Iterator[pa.RecordBatch]:
        for batch in batches:
            for part in settled(iter([batch])):
                signals = matrix(part, names)
                self.low = np.minimum(self.low, signals.min(axis=1, initial=np.inf))
                self.high = np.maximum(self.high, signals.max(axis=1, initial=-np.inf))
            yield batch

    def findings(self, robot: Robot, period: float) -> list[Finding]:
        """What is not in order, for rows every `period` [s]."""
        ends = np.column_stack((self.low, self.high))
        if not np.all(self.low <= self.high) or self._usual(ends, robot, period):
            return []
        from scarid_cli.stages.remarks.glance import of_extremes

        return of_extremes(ends[: self.joints], ends[self.joints :], robot, period)

    def _usual(self, ends: Array, robot: Robot, period: float) -> bool:
        """Whether nothing can be out of order, because all is within the limits."""
        reach = np.abs(ends).max(axis=1)
        joints = list(zip(robot.joints, ends[: self.joints], reach[self.joints :], strict=True))
        within = all(
            max(joint.lower, -FARTHEST) <= low
            and high <= min(joint.upper, FARTHEST)
            and torque <= joint.torque_limit
            for joint, (low, high), torque in joints
        )
        used = any(not torque < LEAST * joint.torque_limit < np.inf for joint, _, torque in joints)
        return period <= LONGEST and within and used
