"""The segments of a record without the time by which the torques lead the motion.

A torque of another instant is the less explained the faster it changes. The scatter of the
parameters then grows with the cut-off, as if the high frequencies were noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from scarid_cli.algorithms.regression.shifting import interpolated, nodes
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.lowpassed import Lowpassed, Segment, lowpassed
from scarid_cli.algorithms.tuning.scatter import PARTS, solved, sums_of, weighted_sums
from scarid_cli.arrays import Array

FITS = 5  # at most, each without the lead that those before have found
NEAR = 0.05  # of a sample: a lead that remains
SLOPES = 3  # fits, each with the slope of the torques that the one before predicts
PHASE = 0.05  # rad at the cut-off, up to which a lead does not matter
DEVIATIONS = 3.0  # standard errors, up to which it may be none
LONGEST = 0.25  # of a segment
FEWEST = 2  # rows of a segment that have a slope


def without_lead(
    robot: Robot, segments: Sequence[Segment], h: float, cutoff: float
) -> list[Segment]:
    """The segments, sampled every h [s], with the torques in step with the motion.

    There are none if the lead behind a low-pass of this cut-off [Hz] does not matter.
    """
    steady, seconds = list(segments), 0.0
    longest = LONGEST * h * min(s.q.shape[1] for s in segments)
    for _ in range(FITS):
        parts = [part for s in steady if (part := lowpassed(s, h, cutoff, robot.motors))]
        parts = [part for part in parts if part.counts.shape[1] >= FEWEST]
        if not parts:
            return []
        rest, error = _lead(robot, parts)
        seconds += rest
        least = max(PHASE / (2.0 * pi * cutoff), DEVIATIONS * error)
        if not least < abs(seconds) < longest:
            return []
        steady = [_in_step(s, seconds / h) for s in segments]
        if abs(rest) < NEAR * h:
            break
    return steady


def _lead(robot: Robot, parts: Sequence[Lowpassed]) -> tuple[float, float]:
    """The lead [s] of the torques in the linear form, and its error by leaving out parts."""
    W = [robot.regressor(*part.motion[:3]) for part in parts]
    tau = np.concatenate([part.motion[3] for part in parts], axis=1)
    counts = np.concatenate([part.counts for part in parts], axis=1)
    theta = np.zeros(W[0].shape[2] + 1)
    for _ in range(SLOPES):
        slopes = [_slope(x @ theta[:-1], part.interval) for x, part in zip(W, parts, strict=True)]
        columns = [np.concatenate(x, axis=2) for x in zip(W, slopes, strict=True)]
        sums = weighted_sums(sums_of(np.concatenate(columns), tau, counts), counts.sum(axis=1))
        theta = solved(sums.sum(axis=0))
    without = solved(sums.sum(axis=0) - sums)[:, -1]
    return float(theta[-1]), float(np.sqrt((PARTS - 1) * np.var(without)))


def _slope(torques: Array, interval: float) -> Array:
    """The derivative of torques (rows, joints) as a column (rows, joints, 1)."""
    return np.gradient(torques, interval, axis=0)[:, :, None]


def _in_step(segment: Segment, lead: float) -> Segment:
    """The segment with the torques of so many samples earlier, where there are any."""
    places = np.arange(segment.q.shape[1])[:, None] + nodes(-lead)
    known = np.all((places >= 0) & (places < len(places)), axis=1)
    tau = segment.tau.T
    tau = interpolated(tau, np.zeros_like(tau), places[known], -lead)
    q = np.ascontiguousarray(segment.q[:, known])
    return replace(segment, q=q, tau=np.ascontiguousarray(tau.T))
