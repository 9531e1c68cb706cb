"""Whether the default settings of a soft sensor suit the log that it is used on."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import pi

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix

COARSE = 4.0  # times the noise that the settings state, from which on a resolution is coarse
FAST = 0.25  # of the bandwidth, from which on the mean frequency of a motion is high
SAMPLED = 0.2  # of the sampling rate, from which on a bandwidth is high


@dataclass
class Watch:
    """What passes through a soft sensor with some joints: `steps` [rad or m] of the positions.

    `steps` (joints) are the smallest ones, `squares` (2, joints) the sums of squares of velocity
    and acceleration.
    """

    joints: int
    steps: Array = field(init=False)
    squares: Array = field(init=False)
    last: Array | None = None

    def __post_init__(self) -> None:
        self.steps = np.full(self.joints, np.inf)
        self.squares = np.zeros((2, self.joints))

    def positions(self, log: Table) -> Table:
        """The log, whose positions are watched."""
        return replace(log, batches=self._positions(log.batches))

    def derivatives(self, motion: Table) -> Table:
        """The motion, whose derivatives are watched."""
        return replace(motion, batches=self._derivatives(motion.batches))

    def _positions(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        names = of_joints(self.joints, "q{i}")
        for batch in batches:
            q = matrix(batch, names)
            before = q[:, :1] if self.last is None else self.last
            steps = np.abs(q - np.concatenate((before, q[:, :-1]), axis=1))
            least = np.where(steps > 0.0, steps, np.inf).min(axis=1, initial=np.inf)
            self.steps = np.minimum(self.steps, least)
            self.last = q[:, -1:]
            yield batch

    def _derivatives(self, batches: Iterator[pa.RecordBatch]) -> Iterator[pa.RecordBatch]:
        names = of_joints(self.joints, "dq{i}", "ddq{i}")
        for batch in batches:
            values = matrix(batch, names).reshape(2, self.joints, batch.num_rows)
            self.squares += (values**2).sum(axis=2)
            yield batch

    def remarks(self, noise: float, bandwidth: float, h: float) -> list[str]:
        """Where settings with this noise [rad or m] and bandwidth [Hz] do not suit; h [s]."""
        found = []
        resolutions = self.steps[np.isfinite(self.steps)]
        coarse = float(resolutions.max(initial=0.0))
        if coarse / np.sqrt(12.0) > COARSE * noise:
            found.append(f"the positions have a resolution of {coarse:.2g} rad or m")
        if bandwidth * h > SAMPLED:
            found.append(f"the rate of {1.0 / h:.4g} Hz is low for them")
        v, a = np.sqrt(self.squares)
        frequency = float(np.max(a / np.where(v > 0.0, v, np.inf)) / (2.0 * pi))
        if frequency > FAST * bandwidth:
            found.append(
                f"the mean frequency of the estimated motion is {frequency:.2g} Hz, from a fast "
                "motion, noise or vibration"
            )
        return found
