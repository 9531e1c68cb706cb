"""Torques of another instant: a shift by any number of samples, by interpolation.

A low-pass of first order shifts torques as well, and bends them. If the log has the command of a
drive, tau_log = tau + T dtau/dt, and if it has a low-passed torque, tau_log + abs(T) dtau_log/dt =
tau with T < 0. To second order both are tau(t + T) - T abs(T) / 2 d2tau/dt2.

Between samples a polynomial of degree five goes through the six nearest (Lagrange). Its error is
less than 0.005 (w h)^6 of a component of angular frequency w, sampled every h: 1e-5 of 5 Hz at
100 Hz. Whole samples are only moved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, curvature, runs
from scarid_cli.arrays import Array, Numbers

NODES = np.arange(-2, 4)  # of the polynomial, counted from the last sample before the instant
REACH = 5  # samples needed on either side: three by an interpolation, two by a second derivative


def shifted(rows: Rows, shift: float) -> Rows:
    """The rows with the torques of `shift` samples earlier; without those that have none."""
    if not shift:
        return rows
    nodes, taps = _interpolation(-shift)
    places = np.arange(rows.samples)[:, None] + nodes
    inside = np.clip(places, 0, rows.samples - 1)
    known = (places == inside) & (rows.at[inside] == rows.at[:, None] + nodes)
    motion = rows.motion.copy()
    motion[3] = _sum(taps, motion[3].T, inside).T
    return replace(
        rows,
        y=_sum(taps, rows.y, inside),
        scales=rows.scales * known.all(axis=1)[:, None],
        motion=motion,
    )


def led(rows: Rows, predicted: Array, delay: float, *, low_pass: bool = False) -> Array:
    """Predicted torques (samples, joints) as a measurement shows them that leads by the delay [s].

    With `low_pass` it leads as behind a low-pass of first order. Near the end of a run its last
    sample takes the place of those that are missing.
    """
    if low_pass:
        predicted = predicted - bend(rows, predicted, delay)
    nodes, taps = _interpolation(delay / rows.h if rows.h > 0.0 else 0.0)
    found = np.empty_like(predicted)
    for run in runs(rows.at):
        places = np.arange(run.start, run.stop)[:, None] + nodes
        found[run] = _sum(taps, predicted, np.clip(places, run.start, run.stop - 1))
    return found


def bend(rows: Rows, predicted: Array, delay: float) -> Array:
    """What torques (samples, joints) lack behind a low-pass, compared with ones delayed by as much.

    `delay` [s] is the time T by which the torques lead.
    """
    found: Array = 0.5 * delay * abs(delay) * curvature(rows, predicted)
    return found


def straightened(rows: Rows, predicted: Array, delay: float) -> Rows:
    """The rows with torques as if a delay had caused the lead, and not a low-pass."""
    return replace(rows, y=rows.y + bend(rows, predicted, delay))


def _interpolation(samples: float) -> tuple[Numbers, Array]:
    """The samples around an instant that is so many samples later, and their weights."""
    whole = int(np.floor(samples))
    fraction = samples - whole
    if fraction == 0.0:
        return np.array([whole]), np.ones(1)
    others = [np.delete(NODES, k) for k in range(len(NODES))]
    taps = [np.prod((fraction - o) / (n - o)) for n, o in zip(NODES, others, strict=True)]
    return whole + NODES, np.array(taps)


def _sum(taps: Array, x: Array, places: Numbers) -> Array:
    """The weighted sum of the samples of x (samples, joints) at these places (samples, taps)."""
    found = np.zeros((len(places), x.shape[1]))
    for tap, at in zip(taps, places.T, strict=True):
        found += tap * x[at]
    return found
