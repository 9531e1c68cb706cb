"""The rows behind one low-pass, with alternatives for the positions and their derivatives.

The regressor is computed again from differences of the logged positions, and passes the same
zero-phase window as the torques. Beside it stand the columns of what may be wrong with the
signals: a delay, a low-pass of the logged torque, errors of the encoders, elastic transmissions.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from scarid_cli.algorithms.beyond.catalogue import POSITIONS
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.positions import Differences
from scarid_cli.algorithms.beyond.sensitivities import Sensitivities
from scarid_cli.algorithms.regression.rows import Rows, delay_column, runs
from scarid_cli.algorithms.uncertainty.reversals import hann
from scarid_cli.arrays import Array, Numbers

STEP = 0.025  # s between the rows that are kept: the window passes hardly anything above 10 Hz
CENTRES = 1024  # rows that are computed at once: many columns stand beside them
EDGE = 4  # samples at both ends of a run where the differences are not central


@dataclass(frozen=True)
class Smoothed:
    """Rows A = [W, further columns, y] (samples, joints, columns + 1) behind the Hann window.

    `at` (samples) are their numbers in the record, and `centres` their places among the rows.
    `places` are the numbers of the further columns of each alternative.
    """

    A: Array
    at: Numbers
    centres: Numbers
    places: dict[str, list[int]]


def smoothed(rows: Rows, model: Model | None, estimates: Array, own: int) -> Smoothed | None:
    """The rows behind one zero-phase Hann window, with W from differences of the position.

    The further columns are those of beyond/positions.py. Without a model the columns of W are only
    smoothed, and there are no further ones. None if every run between gaps is shorter than the
    window.
    """
    window = Window.of(rows.h)
    parts = [part for run in runs(rows.at) for part in window.parts(run)]
    if not parts:
        return None
    centres = window.centres_of(parts)
    A, start, sizes = np.empty(0), 0, dict[str, int]()
    for part in parts:
        columns = _columns(rows.part(part), model, estimates, own, window)
        if not sizes:
            sizes = {name: x.shape[2] for name, x in columns.items()}
            A = np.empty((len(centres), rows.y.shape[1], sum(sizes.values())))
        count = len(columns["y"])
        np.concatenate([*columns.values()], axis=2, out=A[start : start + count])
        start += count
    return Smoothed(A, rows.at[centres], centres, _places(sizes))


def _places(sizes: dict[str, int]) -> dict[str, list[int]]:
    """The places of the columns of each alternative, in A of columns of these names and sizes."""
    places, start = {}, 0
    for name, size in sizes.items():
        places[name] = list(range(start, start + size))
        start += size
    beside = {name: kind.BESIDE for name, kind in POSITIONS.items() if name in places}
    return {
        name: [k for other in (*others, name) for k in places[other]]
        for name, others in beside.items()
    }


@dataclass(frozen=True)
class Window:
    """A zero-phase window of these taps, of whose output every `step`-th row is kept."""

    taps: Array
    step: int

    @classmethod
    def of(cls, h: float) -> Window:
        """The Hann window for rows that are h [s] apart."""
        return cls(hann(h), max(1, int(STEP / h + 1e-9)) if h > 0.0 else 1)

    def centres(self, samples: int) -> Numbers:
        """The samples of a run at which the window is inside, away from its edges."""
        edge = len(self.taps) // 2 + EDGE
        return np.arange(edge, samples - edge, self.step)

    def centres_of(self, parts: list[slice]) -> Numbers:
        """The samples at which the window is inside of these parts of a record."""
        found = [part.start + self.centres(part.stop - part.start) for part in parts]
        return np.concatenate([np.empty(0, dtype=np.int64), *found])

    def parts(self, run: slice) -> list[slice]:
        """The parts of a run (rows) with a centre or more, whose centres are those of the run."""
        edge = len(self.taps) // 2 + EDGE
        rows = self.step * CENTRES
        starts = range(run.start, run.stop - 2 * edge, rows)
        ends = (min(run.stop, start + rows - self.step + 2 * edge + 1) for start in starts)
        return [slice(start, end) for start, end in zip(starts, ends, strict=True)]

    def passed(self, x: Array) -> Array:
        """x (samples, ...) of a run behind the window, at its centres."""
        inside = np.ascontiguousarray(x[EDGE : len(x) - EDGE])
        around = sliding_window_view(inside, len(self.taps), axis=0)[:: self.step]
        return np.asarray(np.einsum("...t,t->...", around, self.taps))


def _columns(
    rows: Rows, model: Model | None, estimates: Array, own: int, window: Window
) -> dict[str, Array]:
    """The columns of one run behind the window, by name, in the order of A."""
    y = window.passed(rows.y[:, :, None])
    if model is None:
        return {"W": window.passed(rows.W), "y": y}
    q, h, theta = rows.motion[0], rows.h, estimates[:own]
    dq, ddq = differences(q, h)
    W = model.regressor(q, dq, ddq)
    carried = np.flatnonzero(model.transmits)
    motion = np.stack((q, dq, ddq))
    further = Differences(
        rows=replace(rows, motion=np.stack((q, dq, ddq, rows.motion[3]))),
        model=model,
        sensitivities=Sensitivities.of(model, theta, motion),
        whole=W @ theta,
        links=model.link_torques(motion, theta),
        transmitted=W[:, :, carried] @ theta[carried],
        still=model.regressor(q, dq, np.zeros_like(ddq)) @ theta,
        delayed=rows.W.shape[2] > own,
    )
    if further.delayed:
        delay = delay_column(further.rows, further.whole)
        W = np.concatenate((W, rows.W[:, :, own:-1], delay[:, :, None]), axis=2)
    columns = {name: window.passed(kind.columns(further)) for name, kind in POSITIONS.items()}
    return {"W": window.passed(W), **columns, "y": y}


def differences(q: Array, h: float) -> tuple[Array, Array]:
    """Velocity and acceleration by central differences over five samples (joints, samples).

    They are exact for polynomials of degree four and five; two samples at both ends are 0.
    """
    dq, ddq = np.zeros_like(q), np.zeros_like(q)
    sides, far = q[:, 3:-1], q[:, 4:]
    before, first = q[:, 1:-3], q[:, :-4]
    dq[:, 2:-2] = (8.0 * (sides - before) - (far - first)) / (12.0 * h)
    ddq[:, 2:-2] = (16.0 * (sides + before) - (far + first) - 30.0 * q[:, 2:-2]) / (12.0 * h**2)
    return dq, ddq
