"""The checks that cost next to nothing, which `identify` makes by itself.

Rows that stream through are watched for their extremes only. A measurement, which is in memory, is
also looked at for held samples and for clipping.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.checks import clock, units, values
from scarid_cli.algorithms.checks.finding import OK, Finding
from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, settled
from scarid_cli.stages.logs import log_of


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
        if not np.all(self.low <= self.high):
            return []
        ends = np.column_stack((self.low, self.high))
        log = Log(np.zeros(2), ends[: self.joints], ends[self.joints :])
        none = np.full(self.joints, np.nan)
        found = [
            units.positions(log, robot, np.zeros(self.joints))[0],
            units.torques(log, robot, none),
        ]
        if period:
            found.append(clock.unit(clock.Clock(np.array([period]), period))[0])
        return [finding for finding in found if finding.status != OK]


def of_measurement(table: Table, robot: Robot) -> list[Finding]:
    """What is not in order in the values of a measurement in memory."""
    log = log_of(table, len(robot.joints))
    found = [clock.held(log, table.period), values.saturation(log.tau)]
    return [finding for finding in found if finding.status != OK]
