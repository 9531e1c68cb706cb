"""How well identified parameters predict the motion: `scarid validate --rollout`.

The log is cut into windows. From the measured state at the start of each, the model moves by the
measured torques alone; how far its positions are from the measured ones, after a quarter, a half
and all of the window, stands beside how far a constant velocity would be, and beside how far the
joint moves. Windows that do not move a joint count as well.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from scarid_cli.algorithms.plants.loop import IndefiniteError
from scarid_cli.algorithms.plants.rollout import OpenLoop
from scarid_cli.algorithms.regression.rows import Rows, joined, runs
from scarid_cli.algorithms.regression.shifting import in_step, reach
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault
from scarid_cli.io.table import Table
from scarid_cli.stages.results.parameters import Identified
from scarid_cli.stages.results.prediction import Part
from scarid_cli.words import percents_of_joints

PARTS = (0.25, 0.5, 1.0)  # of the window: the horizons
MODEL, STILL, STEADY = range(3)  # what predicts: the model, the first position, the first velocity


@dataclass
class Rollouts:
    """Keeps the sums over the windows of a motion of `seconds` each."""

    seconds: float
    count: int = 0
    lost: int = 0  # windows in which the model left all bounds
    sums: Array = field(default_factory=lambda: np.zeros(0))  # (predictors, horizons, joints)

    def watched(self, parts: Iterator[Part], model: Identified, table: Table) -> Iterator[Part]:
        """The parts of the rows of a motion, whose windows are rolled out as they pass."""
        period = table.period
        steps = round(self.seconds / period) if period > 0.0 else 0
        if steps < len(PARTS) + 1:
            raise UsageFault(
                f"--rollout {self.seconds:g}: the window has {steps} samples; give a longer one"
            )
        loop = OpenLoop(model.robot, model.theta)
        self.sums = np.zeros((3, len(PARTS), len(model.robot.joints)))
        margin = reach(model.delay, period, low_pass=model.low_pass)
        held: list[Rows] = []
        for part in parts:
            rows = joined([*held, part[1]])
            for run in runs(rows.at):
                rest = self._windows(loop, model, rows.part(run), steps, margin)
            held = [rest]
            yield part

    def _windows(
        self, loop: OpenLoop, model: Identified, rows: Rows, steps: int, margin: int
    ) -> Rows:
        """Roll out all whole windows of consecutive rows; returns the rows behind them."""
        whole, start = steps + 1 + 2 * margin, 0
        while start + whole <= rows.samples:
            self._window(loop, model, rows.part(slice(start, start + whole)), margin)
            start += steps
        return rows.part(slice(start, None))

    def _window(self, loop: OpenLoop, model: Identified, rows: Rows, margin: int) -> None:
        rows = in_step(rows, model.theta, model.delay, low_pass=model.low_pass)
        beside = model.shapes.torques(rows) if model.additions else 0.0
        own = slice(margin, rows.samples - margin)
        torques = np.ascontiguousarray((rows.y - beside)[own].T)
        q, dq = rows.motion[:2, :, own]
        try:
            found = loop.positions(q[:, 0], dq[:, 0], torques, rows.h)
        except IndefiniteError:
            raise UsageFault(
                "--rollout: the inertia matrix of the parameters is not positive definite, so they "
                "cannot be simulated; identify with --consistent"
            ) from None
        steps = q.shape[1] - 1
        at = [round(part * steps) for part in PARTS]
        t = rows.h * np.arange(steps + 1)
        first = q[:, :1] + np.zeros_like(t)
        predictions = np.array([found, first, first + dq[:, :1] * t])
        misses = (predictions - q)[:, :, at]
        if not np.isfinite(misses).all():
            self.lost += 1
            return
        self.count += 1
        self.sums += np.swapaxes(misses**2, 1, 2)

    @property
    def misses(self) -> Array:
        """The rms errors (predictors, horizons, joints) [rad or m]."""
        return np.asarray(np.sqrt(self.sums / max(self.count, 1)))

    @property
    def extra(self) -> dict[str, Any]:
        """For the metadata of the metrics."""
        misses = self.misses
        horizons = [
            {
                "seconds": part * self.seconds,
                "error": misses[MODEL, k].tolist(),
                "of_constant_velocity": misses[STEADY, k].tolist(),
                "movement": misses[STILL, k].tolist(),
            }
            for k, part in enumerate(PARTS)
        ]
        return {"rollout": {"windows": self.count, "lost": self.lost, "horizons": horizons}}

    def told(self, _: dict[str, Any] | None) -> list[str]:
        """A line for each horizon."""
        if not self.count:
            lost = f"; in {self.lost} of them the model leaves all bounds" if self.lost else ""
            return [f"rollout: no window of {self.seconds:g} s that could be judged{lost}"]
        lost = f"; {self.lost} more, in which the model leaves all bounds" if self.lost else ""
        lines = [f"rollout: from {self.count} measured states, by the measured torques{lost}"]
        for k, part in enumerate(PARTS):
            with np.errstate(divide="ignore", invalid="ignore"):
                model, _, steady = self.misses[:, k] / self.misses[STILL, k]
            lines.append(
                f"rollout: after {part * self.seconds:g} s the positions are off by "
                f"{percents_of_joints(model)} of the movement (at constant velocity "
                f"{percents_of_joints(steady)})"
            )
        return lines
