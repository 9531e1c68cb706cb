"""Torques of another instant: a shift by any number of samples, by interpolation.

A low-pass of first order shifts torques as well, and bends them. If the log has the command of a
drive, tau_log = tau + T dtau/dt, and if it has a low-passed torque, tau_log + abs(T) dtau_log/dt =
tau with T < 0. To second order both are tau(t + T) - T abs(T) / 2 d2tau/dt2.

Between samples a polynomial of degree five goes through the six nearest (Lagrange). Its error is
less than 0.005 (w h)^6 of a component of angular frequency w, sampled every h: 1e-5 of 5 Hz at
100 Hz. Coulomb friction jumps where a joint reverses. No polynomial goes through samples on both
sides of a reversal: near it a straight line goes through the two nearest ones, or the nearest one
is taken. Whole samples are only moved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, curvature, predicted, runs
from scarid_cli.arrays import Array, Numbers

NODES = np.arange(-2, 4)  # of the polynomial, counted from the last sample before the instant
REACH = 5  # samples needed on either side: three by an interpolation, two by a second derivative


def shifted(rows: Rows, shift: float) -> Rows:
    """The rows with the torques of `shift` samples earlier; without those that have none."""
    if not shift:
        return rows
    here = np.arange(rows.samples)
    around = nodes(-shift)
    places = here[:, None] + around
    inside = np.clip(places, 0, rows.samples - 1)
    known = (places == inside) & (rows.at[inside] == rows.at[:, None] + around)
    # The torque of a sample belongs to the motion that many samples later.
    motion, of_motion = rows.motion.copy(), np.clip(here + round(shift), 0, rows.samples - 1)
    torques = np.concatenate((rows.y, motion[3].T), axis=1)
    directions = np.tile(_directions(rows)[of_motion], 2)
    y, torque = np.split(interpolated(torques, directions, inside, -shift), 2, axis=1)
    motion[3] = torque.T
    scales = rows.scales * known.all(axis=1)[:, None]
    return replace(rows, y=np.ascontiguousarray(y), scales=scales, motion=motion)


def led(rows: Rows, predicted: Array, delay: float, *, low_pass: bool = False) -> Array:
    """Predicted torques (samples, joints) as a measurement shows them that leads by the delay [s].

    With `low_pass` it leads as behind a low-pass of first order. Near the end of a run its last
    sample takes the place of those that are missing.
    """
    if low_pass:
        predicted = predicted - bend(rows, predicted, delay)
    samples = delay / rows.h if rows.h > 0.0 else 0.0
    places = np.arange(rows.samples)[:, None] + nodes(samples)
    for run in runs(rows.at):
        places[run] = np.clip(places[run], run.start, run.stop - 1)
    return interpolated(predicted, _directions(rows), places, samples)


def in_step(rows: Rows, theta: Array, delay: float, *, low_pass: bool = False) -> Rows:
    """The rows with torques that do not lead the motion: the reverse of `led`."""
    if not (delay and rows.h > 0.0):
        return rows
    rows = shifted(rows, delay / rows.h)
    return replace(rows, y=rows.y + bend(rows, predicted(rows, theta), delay)) if low_pass else rows


def _directions(rows: Rows) -> Array:
    """In which direction each joint moves (samples, joints)."""
    return np.asarray(np.sign(rows.motion[1].T))


def bend(rows: Rows, predicted: Array, delay: float) -> Array:
    """What torques (samples, joints) lack behind a low-pass, compared with ones delayed by as much.

    `delay` [s] is the time T by which the torques lead.
    """
    found: Array = 0.5 * delay * abs(delay) * curvature(rows, predicted)
    return found


def nodes(samples: float) -> Numbers:
    """The samples around an instant that is so many samples later."""
    whole = int(np.floor(samples))
    return whole + (NODES if samples > whole else NODES[NODES == 0])


def interpolated(x: Array, directions: Array, places: Numbers, samples: float) -> Array:
    """x (samples, joints) so many samples later, from the samples in these places (samples, nodes).

    directions: those of the joints at each sample of x.
    """
    whole = int(np.floor(samples))
    fraction = samples - whole
    if fraction == 0.0:
        return x[places[:, 0]]
    before, after = (places[:, k] for k in np.flatnonzero((NODES == 0) | (NODES == 1)))
    nearest = after if round(samples) > whole else before
    same = [directions[at] == directions[nearest] for at in places.T]
    pair = directions[before] == directions[after]
    line = np.where(pair, (1.0 - fraction) * x[before] + fraction * x[after], x[nearest])
    others = [np.delete(NODES, k) for k in range(len(NODES))]
    taps = [np.prod((fraction - o) / (n - o)) for n, o in zip(NODES, others, strict=True)]
    smooth = sum(tap * x[at] for tap, at in zip(taps, places.T, strict=True))
    return np.where(np.logical_and.reduce(same), smooth, line)
