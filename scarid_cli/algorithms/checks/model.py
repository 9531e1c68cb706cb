"""A first fit of the robot's model to the rows of a log, for the checks that need the model.

To the columns of the robot are added, for each joint, its own viscous and Coulomb friction, an
offset and the derivative of its torque, so that friction that the description lacks or a delay of
the torques does not look like anything else.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from scarid_cli.algorithms.beyond.signals import diagonal
from scarid_cli.algorithms.changes.wiring import Wiring
from scarid_cli.algorithms.regression.grams import grams
from scarid_cli.algorithms.regression.normal_equations import inverse, roots
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, Marks, Numbers

if TYPE_CHECKING:
    from scarid_cli.algorithms.tuning.lowpassed import Lowpassed

PER_COLUMN, FEWEST, MOST = 8, 300, 1500  # samples that are fitted, spread over the log
EXTRA = 4  # columns added for each joint: viscous, Coulomb, offset, derivative of the torque
FRICTION = 2  # of which the first are friction
RIDGE = 1e-10  # added to the squares of columns of unit length, so that all is determined
MOST_JOINTS = 12  # whose signs are tried all at once
EXACT = 1e-9  # of the mean square torque, below which a residual is rounding
DEVIATIONS = 3.0  # standard errors from which on a sign is known
PARTS = 10  # of a log, by whose scatter errors are stated


@dataclass(frozen=True)
class Samples:
    """Position, velocity, acceleration, torque, its derivative (5, joints, samples), and counts.

    `counts` (joints, samples) says which rows count, and `independent` is the share of the samples
    that are independent of each other behind the low-pass.
    """

    motion: Array
    counts: Marks
    independent: float

    @classmethod
    def of(cls, parts: Sequence[Lowpassed], span: float, cutoff: float, samples: int) -> Samples:
        """So many samples of parts of a record, `span` [s] in all, behind a cut-off [Hz]."""
        kept = sum(part.counts.shape[1] for part in parts)
        step = span / kept
        motion = np.concatenate([_with_derivative(part, step) for part in parts], axis=2)
        counts = np.concatenate([part.counts for part in parts], axis=1)
        chosen = _spread(kept, samples)
        independent = min(1.0, 2.0 * cutoff * span / len(chosen))
        return cls(motion[:, :, chosen], counts[:, chosen], independent)

    @classmethod
    def of_rows(cls, rows: Rows, samples: int) -> Samples:
        """So many of the rows of a regression, spread over the record."""
        tau = rows.motion[3]
        slope = np.gradient(tau, rows.h * rows.at, axis=1)
        chosen = _spread(rows.samples, samples)
        motion = np.stack((*rows.motion, slope))[:, :, chosen]
        return cls(motion, rows.scales[chosen].T > 0.0, 1.0)

    def spread(self, samples: int) -> Samples:
        """So many of the samples, spread over the record."""
        chosen = _spread(self.counts.shape[1], samples)
        return replace(self, motion=self.motion[:, :, chosen], counts=self.counts[:, chosen])

    def wired(self, wiring: Wiring) -> Samples:
        """The samples with the signals that each joint has by this wiring."""
        kinematics, tau = wiring.signals(self.motion[:4])
        _, slope = wiring.signals(self.motion[[0, 1, 2, 4]])
        counts = self.counts[list(wiring.places[0])]
        return replace(self, motion=np.stack((*kinematics, tau, slope)), counts=counts)


def _spread(rows: int, samples: int) -> Numbers:
    """The places of so many samples, or of all, spread over the rows."""
    return np.unique(np.linspace(0, rows - 1, samples).astype(np.int64))


def _with_derivative(part: Lowpassed, step: float) -> Array:
    tau = part.motion[3]
    slope = np.gradient(tau, step, axis=1) if tau.shape[1] > 1 else np.zeros_like(tau)
    return np.stack((*part.motion, slope))


def enough(robot: Robot) -> int:
    """How many samples of the log are fitted."""
    count = len(robot.parameters) + EXTRA * len(robot.joints)
    return min(max(PER_COLUMN * count, FEWEST), MOST)


@dataclass(frozen=True)
class Fit:
    """A fit of the columns of the robot and the added ones.

    residuals (joints): the mean square of the residual over that of the torque about its mean.
    powers (joints): the power of the friction over its standard error; negative if the friction
    drives the joint.
    """

    residuals: Array
    powers: Array

    @property
    def misfit(self) -> float:
        """The mean logarithm of the residuals, which weights all joints alike."""
        return float(np.mean(np.log(np.maximum(self.residuals, EXACT))))

    @property
    def driving(self) -> list[int]:
        """The joints (from 0) whose friction is significantly negative."""
        return np.flatnonzero(self.powers < -DEVIATIONS).tolist()

    @property
    def brakes(self) -> bool:
        """Whether the friction of every joint is known to brake it."""
        return bool(self.powers.min() > DEVIATIONS)


def columns(robot: Robot, motion: Array) -> Array:
    """The regressor (samples, joints, parameters + EXTRA joints) with the added columns.

    motion: as that of Samples.
    """
    q, dq, ddq, _, slope = motion
    W = robot.regressor(q, dq, ddq)
    samples, joints, count = W.shape
    wide = np.zeros((samples, joints, count + EXTRA * joints))
    wide[:, :, :count] = W
    for j in range(joints):
        added = (dq[j], np.sign(dq[j]), np.ones(samples), slope[j])
        wide[:, j, count + EXTRA * j : count + EXTRA * (j + 1)] = np.transpose(added)
    return wide


@dataclass(frozen=True)
class Solution:
    """Weighted least squares of W (samples, joints, parameters); weights (joints, samples).

    `rest` (joints, samples) is what it leaves of the torques, `inverse` (parameters, parameters)
    the covariance of theta if rows are independent, and `residuals` (joints) are shares of the mean
    square torque.
    """

    W: Array
    weights: Array
    theta: Array
    rest: Array
    inverse: Array
    residuals: Array

    @cached_property
    def stacked(self) -> Array:
        """The weighted regressor (rows, parameters), joint after joint."""
        return _stacked(self.W, self.weights)

    def scatter(self, joints: int) -> Array:
        """The standard errors (parameters) by leaving out one of PARTS of the log after another."""
        samples = len(self.stacked) // joints
        part = np.tile(np.arange(samples) * PARTS // samples, joints)
        rest = (self.rest * self.weights).ravel()
        sums = np.array([self.stacked[part == k].T @ self.stacked[part == k] for k in range(PARTS)])
        scores = np.array([self.stacked[part == k].T @ rest[part == k] for k in range(PARTS)])
        moved = np.array(
            [inverse(sums.sum(axis=0) - g) @ s for g, s in zip(sums, scores, strict=True)]
        )
        return np.asarray(np.sqrt((PARTS - 1) / PARTS * np.sum(moved**2, axis=0)))


def solved(W: Array, tau: Array, counts: Marks) -> Solution:
    """The fit of tau (joints, samples) by W (samples, joints, parameters).

    Each joint is weighted by the residual of a first fit. What the rows do not determine stays
    near 0.
    """
    scale, rows = _deviations(tau, counts), np.maximum(counts.sum(axis=1), 1)
    each = grams(W, tau, counts)
    weights = 1.0 / scale**2
    first, _ = _solution(np.tensordot(weights, each, (0, 0)))
    left = np.append(-first, 1.0)
    weights = 1.0 / np.maximum((each @ left) @ left / rows, EXACT * scale**2)
    theta, covariance = _solution(np.tensordot(weights, each, (0, 0)))
    predicted = (W.reshape(-1, len(theta)) @ theta).reshape(W.shape[:2]).T
    rest = np.where(counts, tau - predicted, 0.0)
    residuals = np.sum(rest**2, axis=1) / rows / scale**2
    factors = np.where(counts, np.sqrt(weights)[:, None], 0.0)
    return Solution(W, factors, theta, rest, covariance, residuals)


def _solution(products: Array) -> tuple[Array, Array]:
    """The solution of normal equations in [W y]'[W y], and its covariance for unit variances."""
    gram, right = products[:-1, :-1], products[:-1, -1]
    size = np.sqrt(np.diag(gram))
    size = np.where(size > 0.0, size, 1.0)
    scaled = gram / np.outer(size, size) + RIDGE * np.eye(len(size))
    covariance = np.linalg.inv(scaled) / np.outer(size, size)
    return covariance @ right, covariance


def pulled(motion: Array) -> Array:
    """Columns (samples, joints, 2 joints) of a cable at each joint: its position, and the cube."""
    q = motion[0].T
    return np.concatenate((diagonal(q), diagonal(q**3)), axis=2)


def fitted(robot: Robot, samples: Samples, *, cables: bool = False) -> Fit:
    """The fit of the robot's columns and the added ones to these samples, cables if asked for."""
    wide = columns(robot, samples.motion)
    if cables:
        wide = np.concatenate((wide, pulled(samples.motion)), axis=2)
    found = solved(wide, samples.motion[3], samples.counts)
    return Fit(found.residuals, _powers(robot, wide, samples, found))


def torque_signs(robot: Robot, samples: Samples) -> tuple[int, ...]:
    """The sign of the torque of each joint, 1 or -1, with which the model leaves least of them.

    That of joint 1 is 1. Signs leave A'A as it is, and A'y is a sum of the joints with their signs.
    So the squares that a fit explains are known for all signs from the products of one.
    """
    motion, counts = samples.motion, samples.counts
    joints = len(counts)
    if joints > MOST_JOINTS:
        return (1,) * joints
    tau = motion[3]
    wide, weights = columns(robot, motion), 1.0 / _deviations(tau, counts)
    each = grams(wide, tau, counts) * (weights**2)[:, None, None]
    independent, _ = roots(each[:, :-1, :-1].sum(axis=0))
    each = independent.T @ each[:, :-1, -1].T
    signs = np.array(list(product((1,), *[(1, -1)] * (joints - 1))))
    best = np.argmax(np.sum((signs @ each.T) ** 2, axis=1))
    return tuple(signs[best].tolist())


def _deviations(tau: Array, counts: Marks) -> Array:
    """The standard deviation of the torque of each joint over the rows that count."""
    found = [x[k].std() if k.any() else 0.0 for x, k in zip(tau, counts, strict=True)]
    return np.array([x if x > 0.0 else 1.0 for x in found])


def _stacked(W: Array, factors: Array) -> Array:
    """The rows of W (samples, joints, parameters) times factors (joints, samples), by joint."""
    return np.concatenate([W[:, j] * x[:, None] for j, x in enumerate(factors)])


def _powers(robot: Robot, wide: Array, samples: Samples, found: Solution) -> Array:
    """The mean power of the friction of each joint, over its standard error."""
    own = [k for k, p in enumerate(robot.parameters) if p.term.NEVER_NEGATIVE]
    first, dq = len(robot.parameters), samples.motion[1]
    powers = []
    for j in range(len(dq)):
        kept = [*own, *range(first + EXTRA * j, first + EXTRA * j + FRICTION)]
        part = np.zeros(len(found.theta))
        part[kept] = (samples.counts[j] * dq[j]) @ wide[:, j, kept] / len(dq[j])
        variance = part @ found.inverse @ part / samples.independent
        powers.append(part @ found.theta / np.sqrt(variance) if variance > 0.0 else 0.0)
    return np.array(powers)
