"""How far positions and torques reach that stream through: `identify` tells of wrong units."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.checks.finding import Finding
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, settled
from scarid_cli.stages.glance import of_extremes


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
        if not np.all(self.low <= self.high):
            return []
        return of_extremes(ends[: self.joints], ends[self.joints :], robot, period)
