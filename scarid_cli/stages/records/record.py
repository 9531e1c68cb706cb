"""The positions and torques of a log in memory, segment by segment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.filters.likelihood import noise_of
from scarid_cli.algorithms.tuning.lowpassed import Segment
from scarid_cli.arrays import Array
from scarid_cli.io import schemas
from scarid_cli.io.table import Table, matrix, segments


@dataclass(frozen=True)
class Record:
    """Positions and, if they were asked for, torques of a log, sampled every h [s].

    Each of the `parts`, between the gaps of the log, is (joints, rows) of positions, followed by as
    many of torques.
    """

    parts: tuple[Array, ...]
    joints: int
    h: float
    name: str = "log"

    @classmethod
    def of(cls, table: Table, joints: int, *, torques: bool) -> Record:
        names = schemas.of_joints(joints, *("q{i}", "tau{i}")[: 1 + torques])
        parts = tuple(
            np.concatenate([matrix(batch, names) for batch in segment.batches], axis=1)
            for segment in segments(table)
        )
        return cls(parts, joints, table.period, table.name)

    @property
    def longest(self) -> Array:
        """The positions (joints, rows) of the longest segment."""
        part = max(self.parts, key=lambda part: part.shape[1])
        return np.ascontiguousarray(part[: self.joints])

    @property
    def segments(self) -> list[Segment]:
        """The positions and torques of all segments, with the noise of the positions."""
        found = []
        for part in self.parts:
            q, tau = part[: self.joints], part[self.joints :]
            found.append(Segment(q, tau, np.array([noise_of(x) for x in q])))
        return found
