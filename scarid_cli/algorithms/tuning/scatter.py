"""One cut-off for all joints, at which the identified parameters agree best.

A low-pass that is too wide passes noise and vibration, one that is too narrow leaves no excitation
in the rows. Both make the parameters of the parts of a record differ. For a sequence of cut-offs,
positions and torques of all joints pass the same low-pass, parameters are identified by weighted
least squares, and the jackknife over the parts of the record gives their covariance. The scatter is
the share of the variance of the torques that this covariance stands for. To it comes the share of
the bias: noise of the accelerations shrinks parameters towards zero, where they scatter little, but
about wrong values. No prediction error is judged. See docs/theory.md, section "One bandwidth".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from scarid_cli.algorithms.processes.bandwidth import acceleration_noise
from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.algorithms.regression.grams import grams
from scarid_cli.algorithms.regression.information import inverse_deviations
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.lowpassed import Lowpassed, Segment, lowpassed
from scarid_cli.algorithms.tuning.spectrum import bandwidths
from scarid_cli.arrays import Array, Marks, Numbers, varies

STEP = 2.0**0.25  # from one cut-off to the next
PARTS = 20  # of the record, each left out once
ROWS_PER_PARAMETER = 10.0  # independent rows at the first cut-off
LOWEST = 0.5  # Hz
OF_MOTION = 2.0  # times its bandwidth, at which the low-pass takes .4 % from an acceleration
HIGHEST = 0.2  # of the sampling rate
ENOUGH = 2.0  # times the least scatter, at which the sequence ends
FEWEST = 8  # cut-offs before it may end
PLATEAU = 1.5  # times the least scatter, up to which a cut-off is as good as the best
WIDTH = 4  # cut-offs of a plateau
RIDGE = 1e-10  # added to the squares of columns of unit length
EXACT = 1e-12  # share of the torques' squares that counts as no residual
SHAKEN = 512  # rows, at least, that show what noise does to the regressor


@dataclass(frozen=True)
class Scatter:
    """The scatter and bias at a cut-off [Hz], and the number of rows that count of all rows."""

    cutoff: float
    scatter: float
    rows: int
    share: float


@dataclass(frozen=True)
class Estimate:
    """Parameters (parameters), and the squared error that scatter and bias make of the torques.

    theta' squares theta is the share of the variance of the torques that theta explains, in the
    mean over the joints, and `error` is such a share.
    """

    theta: Array
    squares: Array
    error: float


@dataclass(frozen=True)
class Choice:
    """The cut-off that was chosen, and the plateau (lowest and highest cut-off) around it [Hz]."""

    cutoff: float
    plateau: tuple[float, float]


def curve(
    robot: Robot,
    segments: Sequence[Segment],
    h: float,
    progress: Callable[[], object] = lambda: None,
    share: float = 1.0,
) -> list[Scatter]:
    """The scatter over the cut-off, from the lowest one up to where it has doubled; h [s].

    The segments are this `share` of the record.
    """
    found: list[Scatter] = []
    best: Estimate | None = None
    noise = white(segments)
    cutoff = lowest(robot, segments, h)
    while cutoff < HIGHEST / h:
        parts = [part for s in segments if (part := lowpassed(s, h, cutoff, robot.motors))]
        shaken = np.array([acceleration_noise(x, cutoff, h) for x in noise.tolist()])
        point, estimate = at_cutoff(robot, parts, cutoff, shaken, best, share)
        found.append(point)
        if estimate is not None and (best is None or estimate.error < best.error):
            best = estimate
        progress()
        least = min(point.scatter for point in found)
        if len(found) > FEWEST and found[-1].scatter > ENOUGH * least:
            break
        cutoff *= STEP
    return found


def chosen(points: Sequence[Scatter]) -> Choice:
    """The middle of the lowest plateau, in octaves, or the least scatter if no plateau is wide."""
    values = np.array([point.scatter for point in points])
    least = int(np.argmin(values))
    good = values <= PLATEAU * values[least]
    ends = np.flatnonzero(np.diff(good, prepend=False, append=False)).reshape(-1, 2)
    wide = [(first, last - 1) for first, last in ends.tolist() if last - first >= WIDTH]
    first, last = wide[0] if wide else (least, least)
    return Choice(points[(first + last) // 2].cutoff, (points[first].cutoff, points[last].cutoff))


def lowest(robot: Robot, segments: Sequence[Segment], h: float) -> float:
    """The lowest cut-off: with ten independent rows for each parameter, and above the motion.

    Below the bandwidth of the motion the parameters may scatter little, and are wrong nevertheless.
    It is at most that of the torques, which positions in steps do not increase. A short log has
    less rows, so that an octave is left to choose from.
    """
    rows = sum(s.q.size for s in segments)
    motion = OF_MOTION * min(float(x.max()) for x in bandwidths(segments, h))
    independent = ROWS_PER_PARAMETER * len(robot.parameters) / (2.0 * rows * h)
    return max(LOWEST, min(max(independent, motion), 0.5 * HIGHEST / h))


def white(segments: Sequence[Segment]) -> Array:
    """The standard deviation (joints) of the white noise that the positions are taken to have.

    A sensor that changes in every n-th row only makes errors that last n rows: the density of n
    times the square of an error that lasts one.
    """
    longest = max(segments, key=lambda segment: segment.q.shape[1])
    changes = np.mean(np.diff(longest.q, axis=1) != 0.0, axis=1)
    steps = np.array([resolution_of(q) for q in longest.q])
    rounding = steps / np.sqrt(12.0 * np.where(changes > 0.0, changes, 1.0))
    return np.maximum(longest.noise, rounding)


def at_cutoff(
    robot: Robot,
    parts: Sequence[Lowpassed],
    cutoff: float,
    noise: Array,
    best: Estimate | None,
    sampled: float = 1.0,
) -> tuple[Scatter, Estimate | None]:
    """The jackknife at one cut-off; infinite where the rows do not determine a joint's residual.

    noise (joints) is that of the accelerations, `best` the best estimate of lower cut-offs, and
    `sampled` the share of the record that the parts are: the whole scatters so much less.
    """
    joints, count = len(robot.joints), len(robot.parameters)
    if not parts:
        return Scatter(cutoff, np.inf, 0, 0.0), None
    q, dq, ddq, tau = (
        np.concatenate(x, axis=1) for x in zip(*(p.motion for p in parts), strict=True)
    )
    counts = np.concatenate([p.counts for p in parts], axis=1)
    share = float(np.count_nonzero(counts) / counts.size)
    rows = counts.sum(axis=1)
    if not np.all(rows > count / joints + 1):
        return Scatter(cutoff, np.inf, int(rows.sum()), share), None
    variances = np.array([y[k].var() for y, k in zip(tau, counts, strict=True)])
    sums = np.array([
        grams(robot.regressor(q[:, part], dq[:, part], ddq[:, part]), tau[:, part], counts[:, part])
        for part in parts_of(q.shape[1])
    ])  # fmt: skip
    noises = _of_noise(robot, (q, dq, ddq), noise, counts)
    estimate = _jackknife(sums, noises, rows, variances, best, sampled)
    return Scatter(cutoff, estimate.error, int(rows.sum()), share), estimate


def _of_noise(robot: Robot, motion: tuple[Array, ...], noise: Array, counts: Marks) -> Array:
    """N'N of what noise (joints) of the accelerations adds to W, as `grams` has it for W.

    It is N of some rows for all.
    """
    every = max(1, counts.shape[1] // SHAKEN)
    q, dq, ddq = (x[:, ::every] for x in motion)
    signs = np.random.default_rng(0).choice((-1.0, 1.0), ddq.shape)
    added = robot.regressor(q, dq, ddq + noise[:, None] * signs) - robot.regressor(q, dq, ddq)
    return np.asarray(every * grams(added, np.zeros_like(q), counts[:, ::every]))


def parts_of(samples: int) -> list[slice]:
    """The parts of so many samples."""
    edges = (np.arange(PARTS + 1) * samples // PARTS).tolist()
    return [slice(first, last) for first, last in pairwise(edges)]


def sums_of(W: Array, tau: Array, counts: Marks) -> Array:
    """[W y]'[W y] of the rows that count (parts, joints, parameters + 1, parameters + 1)."""
    return np.array([grams(W[part], tau[:, part], counts[:, part]) for part in parts_of(len(W))])


def _jackknife(
    sums: Array,
    noises: Array,
    rows: Numbers,
    variances: Array,
    best: Estimate | None,
    sampled: float = 1.0,
) -> Estimate:
    """The parameters, with the trace of their covariance and the square of their bias as error.

    sums: of each part and joint, as `sums_of` gives them, and of each joint those of the `noises`;
    rows (joints); variances of the torques (joints); `sampled` is the share of the record. The bias
    is that of the best estimate of lower cut-offs, which noise has shrunk less.
    """
    p = sums.shape[-1] - 1
    total = sums.sum(axis=0)
    weights = _inverse_variances(total, rows)
    weighted = np.tensordot(weights, sums, (0, 1))
    estimates = solved(weighted.sum(axis=0) - weighted)
    theta = estimates.mean(axis=0)
    off = estimates - theta
    driven = varies(variances, total[:, p, p] / rows)
    shares = total[driven, :p, :p] / (rows * variances)[driven, None, None]
    squares = shares.sum(axis=0) / len(rows)
    scatter = sampled * float((PARTS - 1) / PARTS * np.einsum("ki,ij,kj->", off, squares, off))
    clean = best or Estimate(theta, squares, scatter)
    system = weighted.sum(axis=0)
    system[:p, p] = np.tensordot(weights, noises, (0, 0))[:p, :p] @ clean.theta
    bias = solved(system)
    return Estimate(theta, squares, scatter + float(bias @ clean.squares @ bias))


def weighted_sums(sums: Array, rows: Numbers) -> Array:
    """The sums of each part, of all joints, each weighted by one over its variance."""
    return np.tensordot(_inverse_variances(sums.sum(axis=0), rows), sums, (0, 1))


def _inverse_variances(total: Array, rows: Numbers) -> Array:
    """The weight of each joint: one over the variance of its residual in a fit of its own rows."""
    explained = (solved(total) * total[:, :-1, -1]).sum(axis=1)
    squares = np.maximum(total[:, -1, -1] - explained, EXACT * total[:, -1, -1])
    residuals = np.sqrt(squares / rows)
    return np.asarray(inverse_deviations(residuals) ** 2)


def solved(sums: Array) -> Array:
    """The solution of the normal equations in [W y]'[W y], or of a stack of them.

    In units of the columns, a little is added to the diagonal, so that undetermined directions
    remain near 0.
    """
    A, b = sums[..., :-1, :-1], sums[..., :-1, -1]
    size = np.sqrt(np.diagonal(A, axis1=-2, axis2=-1))
    size = np.where(size > 0.0, size, 1.0)
    scaled = A / (size[..., :, None] * size[..., None, :])
    scaled[..., np.arange(b.shape[-1]), np.arange(b.shape[-1])] += RIDGE
    return np.asarray(np.linalg.solve(scaled, (b / size)[..., None])[..., 0] / size)
