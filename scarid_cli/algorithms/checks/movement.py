"""How the robot moves: standstill, joints that hardly move, bandwidths, resolution, repetition."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok, several, warning
from scarid_cli.algorithms.checks.motion import Motion
from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.algorithms.regression.counting import SLOW
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.lowpassed import Lowpassed
from scarid_cli.algorithms.tuning.scatter import HIGHEST
from scarid_cli.arrays import Array

STILL = 0.5  # of the time at rest: the other half would give the same parameters
ROUNDING = 1e-12  # rad/s or m/s: what a low-pass makes of a position that does not change
LITTLE = 0.02  # of the speed of the fastest joint, or of the limit
# Noise of part p of the acceleration reduces inertias by p^2 (errors in variables): 1 % and 25 %.
NOISY, NOISE = 0.1, 0.5
ALIKE = 0.98  # correlation of the positions with themselves a period later
APART = 0.5  # of the same correlation: below it the robot has been elsewhere in between
UNLIKE = 0.1  # of the torques' range of a repeated motion: friction changes or something touches


def standstill(parts: list[Lowpassed]) -> Finding:
    """The share of the rows in which no joint moves, and how often the robot starts."""
    dq = np.concatenate([part.motion[1] for part in parts], axis=1)
    scale = np.sqrt(np.mean(dq**2, axis=1, keepdims=True))
    moves = np.any(np.abs(dq) > SLOW * scale, axis=0)
    starts = int(np.count_nonzero(np.diff(moves.astype(np.int8)) == 1) + moves[0])
    share = 1.0 - float(np.mean(moves))
    figure = f"{100.0 * share:.2g} % of the time, {several(starts, 'start')}"
    if share <= STILL:
        return ok("standstill", figure)
    return warning("standstill", figure, "cut the log to its motion, and check that it ran")


def range_of_joints(parts: list[Lowpassed], robot: Robot) -> Finding:
    """Joints that move far less than they can, or than the others do."""
    dq = np.concatenate([part.motion[1] for part in parts], axis=1)
    speeds = np.sqrt(np.mean(dq**2, axis=1))
    text = ", ".join(
        f"{speed:.2g} {joint.unit}/s" for speed, joint in zip(speeds, robot.joints, strict=True)
    )
    least = [max(LITTLE * _typical(speeds, robot, i), ROUNDING) for i in range(len(speeds))]
    idle = [i for i in range(len(speeds)) if speeds[i] < least[i]]
    if not idle:
        return ok("motion", f"{text} rms")
    names = joints_text(i + 1 for i in idle)
    advice = (
        "excite every joint (`scarid trajgen`), or fix these joints in the description and give "
        "their columns other names (`scarid convert --map`)"
    )
    return failed("motion", f"{names} hardly move{'s' if len(idle) == 1 else ''}: {text}", advice)


def _typical(speeds: Array, robot: Robot, i: int) -> float:
    """The speed of the fastest joint of the same type as joint i [rad/s or m/s]."""
    alike = [j for j, joint in enumerate(robot.joints) if joint.type == robot.joints[i].type]
    return float(speeds[alike].max())


def bandwidths(motion: Motion) -> Finding:
    """The bandwidths of motion and torque, against the rate of the log."""
    moved, driven = motion.bandwidths.max(), motion.torques.max()
    figure = f"motion {moved:.3g} Hz, torque {driven:.3g} Hz"
    if moved <= HIGHEST / motion.h / 2.0:
        return ok("bandwidth", figure)
    advice = f"record at {10.0 * moved:.2g} Hz or more, or move more slowly"
    return warning("bandwidth", f"{figure} at {1.0 / motion.h:.4g} Hz", advice)


def resolution(q: Array, motion: Motion, parts: list[Lowpassed], robot: Robot) -> Finding:
    """The resolution of the positions q (joints, rows), and the noise of the acceleration it makes.

    White noise of the deviation s passes a low-pass of the cut-off B [Hz] with the deviation
    s (2 pi B)^2 (2 h B / 5)^1/2 in the acceleration.
    """
    steps = np.array([resolution_of(x[np.isfinite(x)]) for x in q])
    gain = (2.0 * pi * motion.cutoff) ** 2 * sqrt(2.0 * motion.h * motion.cutoff / 5.0)
    ddq = np.concatenate([part.motion[2] for part in parts], axis=1)
    scale = np.sqrt(np.mean(ddq**2, axis=1))
    noise = gain * steps / sqrt(12.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(scale > 0.0, noise / scale, 0.0)
    worst = int(np.argmax(shares))
    if not steps.any():
        return ok("resolution", "no steps in the positions")
    listed = ", ".join(f"{step:.2g}" if step else "no steps" for step in steps)
    units = " or ".join(dict.fromkeys(joint.unit for joint in robot.joints))
    figure = f"{listed} {units}; noise {100.0 * shares[worst]:.2g} % of the acceleration"
    if shares[worst] <= NOISY:
        return ok("resolution", figure)
    advice = (
        f"the positions of joint {worst + 1} are coarse: log the motor's encoder with all digits, "
        "or move faster"
    )
    status = failed if shares[worst] > NOISE else warning
    return status("resolution", figure, advice)


def repetition(motion: Motion) -> Finding:
    """How well the torques repeat, where the positions do."""
    longest = max(motion.segments, key=lambda segment: segment.q.shape[1])
    period = repeated_after(longest.q)
    if not period:
        return ok("repetition", "the motion does not repeat")
    q, tau = longest.q, longest.tau
    rest = tau[:, period:] - tau[:, :-period]
    scale = np.ptp(tau, axis=1)
    shares = np.sqrt(np.mean(rest**2, axis=1) / 2.0) / np.where(scale > 0.0, scale, 1.0)
    count = q.shape[1] // period
    figure = (
        f"{count} periods of {period * motion.h:.4g} s; the torques differ by "
        f"{', '.join(f'{100.0 * share:.2g}' for share in shares)} % of their range"
    )
    if shares.max() <= UNLIKE:
        return ok("repetition", figure)
    worst = int(np.argmax(shares)) + 1
    advice = f"the torque of joint {worst} does not repeat: warm up, look for contact or noise"
    return warning("repetition", figure, advice)


def repeated_after(q: Array) -> int:
    """The number of rows after which the positions (joints, rows) repeat; 0 if they do not."""
    rows = q.shape[1]
    moving = [_autocorrelation(x - x.mean()) for x in q if np.ptp(x) > 0.0]
    alike = np.mean(moving, axis=0) if moving else np.ones(rows)
    # A motion repeats if at least two whole periods are there, and it is not just slow.
    inner = alike[: rows // 2 + 1]
    left = np.flatnonzero(inner < APART)
    good = np.flatnonzero(inner > ALIKE)
    good = good[good > left[0]] if len(left) else good[:0]
    if not len(good):
        return 0
    ends = np.flatnonzero(np.diff(good) > 1)
    first = good[: int(ends[0]) + 1] if len(ends) else good
    return int(first[np.argmax(inner[first])])


def _autocorrelation(x: Array) -> Array:
    """The correlation of a signal (rows) with itself so many rows later (rows)."""
    rows = len(x)
    products = np.fft.irfft(np.abs(np.fft.rfft(x, 2 * rows)) ** 2)[:rows]
    squares = np.concatenate(([0.0], np.cumsum(x**2)))
    head, tail = squares[rows:0:-1], squares[-1] - squares[:rows]
    found: Array = products / np.maximum(np.sqrt(head * tail), 1e-12 * squares[-1])
    return found
