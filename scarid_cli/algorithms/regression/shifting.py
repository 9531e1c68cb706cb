"""Torques of another instant: a shift by any number of samples, by interpolation.

A low-pass of first order shifts torques as well, and bends them. If the log has the command of a
drive, tau_log = tau + T dtau/dt, and if it has a low-passed torque, tau_log + abs(T) dtau_log/dt =
tau with T < 0. To second order both are tau(t + T) - T abs(T) / 2 d2tau/dt2. This would not do for
slow low-passes: the torque behind one is computed as the sum over the torques before.

Between samples a polynomial of degree five goes through the six nearest (Lagrange). Its error is
less than 0.005 (w h)^6 of a component of angular frequency w, sampled every h: 1e-5 of 5 Hz at
100 Hz. Coulomb friction jumps where a joint reverses. No polynomial goes through samples on both
sides of a reversal: near it a straight line goes through the two nearest ones, or the nearest one
is taken. Whole samples are only moved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, curvature, delay_column, predicted, runs
from scarid_cli.arrays import Array, Numbers

NODES = np.arange(-2, 4)  # of the polynomial, counted from the last sample before the instant
SIDES = 5  # samples needed on either side: three by an interpolation, two by a second derivative
FORGOTTEN = 1e-7  # of the response of a low-pass: the last part, which is not computed


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

    With `low_pass` it leads as behind a low-pass of first order. Near the ends of a run its first
    or last sample takes the place of those that are missing.
    """
    if low_pass and rows.h > 0.0:
        return _low_passed(rows, predicted, delay)
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
    return predicted - led(rows, _low_passed(rows, predicted, delay), -delay)


def _low_passed(rows: Rows, predicted: Array, delay: float) -> Array:
    """Predicted torques (samples, joints) as a low-pass shows them that leads by the delay [s].

    The straight lines between samples are corrected for the curve that the torques take between
    them. Before a run, the torques are taken to have had the slope of its start.
    """
    if delay >= 0.0 or not rows.samples:
        return predicted + delay * delay_column(rows, predicted)
    taps = _taps(rows.h / -delay)
    before = np.arange(1 - len(taps), 0)
    smooth = predicted - rows.h**2 / 12.0 * curvature(rows, predicted)
    found = np.empty_like(predicted)
    for run in runs(rows.at):
        for j, torque in enumerate(smooth[run].T):
            ramp = torque[0] + before * np.diff(torque[:2]).sum()
            found[run, j] = np.convolve(np.append(ramp, torque), taps, "valid")
    return found


def _taps(interval: float) -> Array:
    """The weights of the last sample, the one before and so on in the output of a low-pass.

    Between samples its input follows straight lines. `interval` is that between samples, over the
    time constant.
    """
    decay = np.exp(-interval)
    count = max(1, int(np.ceil(np.log(FORGOTTEN) / -interval)))
    taps = np.append(
        1.0 - (1.0 - decay) / interval, (1.0 - decay) ** 2 / interval * decay ** np.arange(count)
    )
    taps[-1] += 1.0 - taps.sum()
    return taps


def reach(delay: float, h: float, *, low_pass: bool = False) -> int:
    """The samples on either side without which `led` does not predict torques h [s] apart."""
    if not (delay and h > 0.0):
        return 0
    memory = len(_taps(h / -delay)) if low_pass and delay < 0.0 else 0
    return SIDES + abs(round(delay / h)) + memory


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
