"""Alternatives to the model, as rows and columns that are fitted beside it.

A bias matters as far as it moves the estimates. Therefore the estimation is repeated with
alternatives to what it takes for granted: that the friction near reversals follows the model, that
the derivatives of the soft sensor are right, that torque and motion belong to the same instant,
that the joints are stiff, and that friction has no offset, asymmetry or Stribeck effect.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, delay_column, runs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, Marks, Numbers

WINDOW = 0.2  # s: length of the Hann window that smooths all signals
STRIBECK = 0.3  # of the root-mean-square velocity: where the Stribeck effect has decayed
BESIDE_FRICTION = ("offset", "stribeck")  # terms that are not friction alone, but go with it
EDGE = 4  # samples at both ends of a run where the differences are not central


@dataclass(frozen=True)
class Model:
    """The robot whose regressor the rows have, and the indices of the columns that were kept."""

    robot: Robot
    kept: list[int]

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """W of the kept columns (samples, joints, parameters)."""
        return self.robot.regressor(q, dq, ddq)[:, :, self.kept]

    @property
    def transmits(self) -> Marks:
        """Which of the kept parameters are of torques that a joint transmits: all but friction."""
        terms = [self.robot.parameters[i].term for i in self.kept]
        return np.array([not (t.NEVER_NEGATIVE or t.NAME in BESIDE_FRICTION) for t in terms])


def friction_columns(rows: Rows, model: Model | None, estimates: Array) -> dict[str, Array]:
    """Further columns (samples, joints, joints) of each alternative for the friction.

    Friction of gears grows with the torque that they transmit, which only a model can tell.
    """
    v = rows.motion[1].T
    fade = STRIBECK * np.sqrt(np.mean(v**2, axis=0)) + 1e-300
    columns = {
        "offset": _diagonal(np.ones_like(v)),
        "asymmetry": _diagonal(np.abs(v)),
        "Stribeck": _diagonal(np.sign(v) * np.exp(-((v / fade) ** 2))),
    }
    if model:
        own = np.flatnonzero(model.transmits)
        columns["load"] = _diagonal(np.sign(v) * np.abs(rows.W[:, :, own] @ estimates[own]))
    return columns


def _diagonal(values: Array) -> Array:
    """One column for each joint (samples, joints, joints), from its values (samples, joints)."""
    columns = np.zeros((*values.shape, values.shape[1]))
    each = np.arange(values.shape[1])
    columns[:, each, each] = values
    return columns


def away_from_reversals(rows: Rows) -> Array:
    """The scales of the rows, 0 within half a window of a reversal or of a row left out."""
    half = max(1, round(0.5 * WINDOW / rows.h)) if rows.h > 0.0 else 1
    scales = np.zeros_like(rows.scales)
    for run in runs(rows.at):
        direction = np.sign(rows.motion[1][:, run].T) * (rows.scales[run] > 0.0)
        scales[run] = rows.scales[run] * _constant(direction, half)
    return scales


def _constant(x: Array, half: int) -> Array:
    """Whether x (samples, joints) is the same, and not 0, in a window around each sample."""
    samples = len(x)
    changes = (x == 0.0).astype(np.int64)
    changes[1:] += x[1:] != x[:-1]
    sums = np.concatenate((np.zeros((1, x.shape[1]), dtype=np.int64), np.cumsum(changes, axis=0)))
    at = np.arange(samples)
    inside = (at >= half) & (at < samples - half)
    end, start = np.minimum(at + half + 1, samples), np.maximum(at - half, 0)
    still: Array = (sums[end] - sums[start] == 0) & inside[:, None]
    return still


@dataclass(frozen=True)
class Smoothed:
    """Rows A = [W, further columns, y] (samples, joints, columns + 1) behind the Hann window.

    `at` (samples) are their numbers in the record, and `centres` their places among the rows.
    """

    A: Array
    at: Numbers
    centres: Numbers


def smoothed(rows: Rows, model: Model | None, estimates: Array, own: int) -> Smoothed | None:
    """The rows behind one zero-phase Hann window, with W from differences of the position.

    The further columns are, for each joint, the first and the second derivative of the torque of
    inertia and, unless a delay is fitted, the first derivative of the other torques. Without a
    model the columns of W are only smoothed, and there are no further columns. None if every run
    between gaps is shorter than the window.
    """
    half = round(0.5 * WINDOW / rows.h) if rows.h > 0.0 else 0
    taps = np.hanning(2 * half + 3)[1:-1]
    parts = list(_smoothed_runs(rows, model, estimates, own, taps / taps.sum()))
    if not parts:
        return None
    A, centres = (np.concatenate(x) for x in zip(*parts, strict=True))
    return Smoothed(A, rows.at[centres], centres)


def _smoothed_runs(
    rows: Rows, model: Model | None, estimates: Array, own: int, taps: Array
) -> Iterator[tuple[Array, Numbers]]:
    half = len(taps) // 2
    for run in runs(rows.at):
        inner = run.stop - run.start - 2 * (half + EDGE)
        if inner <= 0:
            continue
        A = _differenced(rows.part(run), model, estimates, own)[EDGE:-EDGE]
        sums = sum(tap * A[k : k + inner] for k, tap in enumerate(taps))
        yield np.asarray(sums), run.start + half + EDGE + np.arange(inner)


def _differenced(rows: Rows, model: Model | None, estimates: Array, own: int) -> Array:
    """[W, further columns, y] of one run, W from central differences of the position."""
    y = rows.y[:, :, None]
    if model is None:
        return np.concatenate((rows.W, y), axis=2)
    q, h = rows.motion[0], rows.h
    dq, ddq = differences(q, h)
    W = model.regressor(q, dq, ddq)
    rest = model.regressor(q, dq, np.zeros_like(ddq)) @ estimates[:own]
    inertial = W @ estimates[:own] - rest
    first = np.gradient(inertial, h, axis=0)
    further = [_diagonal(first), _diagonal(np.gradient(first, h, axis=0))]
    moved = replace(rows, motion=np.stack((q, dq, ddq, rows.motion[3])))
    if rows.W.shape[2] > own:
        W = np.concatenate((W, delay_column(moved, inertial + rest)[:, :, None]), axis=2)
    else:
        further.append(_diagonal(delay_column(moved, rest)))
    return np.concatenate((W, *further, y), axis=2)


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
