"""The gain of each joint's torque, from logs of a robot without and with a load that is known.

The logged torques are y_j = k_j W_j theta, with the parameters theta of the robot and the gain k_j
of joint j. Joints share parameters, so that one log tells the gains relative to each other
(inference/gains.py); the load is known, so that two logs tell the rest: theta becomes theta +
B phi, where phi are the ten standard parameters of the load as a part of the last link (Khalil and
Dombre 2002, section 9.7; Gautier and Briot 2011). All is estimated together by Gauss-Newton steps,
from the products of the rows of each joint.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from scarid_cli.algorithms.changes.payload import MASS, MOMENTS
from scarid_cli.algorithms.uncertainty.joint_products import JointProducts
from scarid_cli.arrays import Array, Marks, Numbers

STEPS = 50
CLOSE = 1e-9  # change of the logarithms of the gains, below which they have converged
LARGEST = 0.3  # change of a logarithm in one step
BEFORE = 0.7  # error of the logarithm of a gain, before any log: a factor of two either way
REACH = 1.0  # m: a load is not larger
TINY = 1e-30


@dataclass(frozen=True)
class Load:
    """What is known of a load: its mass [kg], and its centre (3) [m] in the frame of the last axis.

    `mass_error` and `centre_error` are standard errors; the centre is None if it is not known.
    """

    mass: float
    mass_error: float
    centre: Array | None = None
    centre_error: float = 0.0

    def information(self) -> tuple[Array, Array]:
        """The information (10, 10) about the standard parameters, and their likeliest values (10).

        What is not known has an error as large as the load may be.
        """
        error = max(self.mass_error, 1e-6 * self.mass)
        wide = np.array([*(self.mass * REACH**2,) * 6, *(self.mass * REACH,) * 3])
        rows, values = np.diag(np.append(1.0 / wide, 1.0 / error)), np.zeros(10)
        values[MASS] = self.mass
        if self.centre is not None:
            size = self.mass * max(self.centre_error, 1e-6)
            rows[MOMENTS, MOMENTS] = 1.0 / size
            rows[MOMENTS, MASS] = -self.centre / size  # the first moments are mass times centre
            values[MOMENTS] = self.mass * self.centre
        return rows.T @ rows, values


@dataclass(frozen=True)
class Judged:
    """The products of a log, and the `biases` (alternatives, parameters) of its estimates.

    These are how far what the model may lack moves them beyond noise.
    """

    products: JointProducts
    biases: Array


@dataclass(frozen=True)
class Log:
    """What a log says, and how its parameters depend on the unknowns x.

    theta = T x, with T (parameters, unknowns).
    """

    judged: Judged
    T: Array

    @property
    def products(self) -> JointProducts:
        return self.judged.products


@dataclass(frozen=True)
class Gains:
    """The logarithms of the gains (joints), and their covariance (joints, joints).

    `unknowns` are those of the logs, at these gains.
    """

    logarithms: Array
    covariance: Array
    unknowns: Array

    @property
    def factors(self) -> Array:
        return np.exp(self.logarithms)

    @property
    def errors(self) -> Array:
        """The standard errors of the logarithms: relative errors of the gains."""
        return np.sqrt(np.diag(self.covariance))


def with_load(bare: Judged, loaded: Judged, B: Array, shared: Marks, load: Load) -> Gains:
    """The gains, from a log without a load and one with it.

    B (parameters, 10) is how the parameters depend on those of a load. Those that are not `shared`,
    such as friction, may differ from one log to the other.
    """
    p, own = len(B), np.flatnonzero(~shared)
    everywhere, apart = np.eye(p), np.zeros((p, len(own)))
    apart[own, range(len(own))] = 1.0
    T = np.hstack((everywhere, np.zeros_like(apart), np.zeros_like(B)))
    T_loaded = np.hstack((np.where(shared, everywhere, 0.0), apart, B))
    information, values = load.information()
    unknowns = T.shape[1]
    known, mean = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    known[-10:, -10:], mean[-10:] = information, values
    logs = [Log(bare, T), Log(loaded, T_loaded)]
    return fitted(logs, known, mean)


def alone(judged: Judged, error: float, fixed: Collection[int]) -> Gains:
    """The gains relative to those of the joints (from 0) that are `fixed`, from one log."""
    p = judged.products.values.shape[1] - 1
    return fitted([Log(judged, np.eye(p))], np.zeros((p, p)), np.zeros(p), error, fixed)


def scaled(found: Gains, apriori: Array, moments: Numbers, untold: Collection[int]) -> Gains:
    """The gains with the factor by which the first moments are those of a description.

    `moments` are the places of the first moments among the parameters, of which a description has
    `apriori` values. They are the gravity torques of a robot. The error of the factor is that of
    regression: what the moments scatter about the description's.
    """
    a, b = apriori[moments], found.unknowns[moments]
    factor = float(a @ b / (a @ a))
    rest = a * (b - factor * a)
    error = sqrt(float(rest @ rest) * len(a) / (len(a) - 1)) / float(a @ a)
    told = np.array([j not in untold for j in range(len(found.logarithms))], dtype=np.float64)
    logarithms = found.logarithms + np.log(factor) * told
    covariance = found.covariance + (error / factor) ** 2 * np.outer(told, told)
    return Gains(logarithms, covariance, found.unknowns / factor)


def fitted(
    logs: Sequence[Log],
    known: Array,
    mean: Array,
    error: float = BEFORE,
    fixed: Collection[int] = (),
) -> Gains:
    """The gains that fit all logs, of which each is known to this relative `error` beforehand.

    `known` (unknowns, unknowns) is the information about the unknowns, whose likeliest values are
    their `mean`. The gains of the joints that are `fixed` (from 0) are 1.
    """
    joints = len(logs[0].products.values)
    free = [j for j in range(joints) if j not in fixed]
    u, n = np.zeros(joints), len(mean)
    weights = [np.ones(joints) for _ in logs]
    for _ in range(STEPS):
        x = _unknowns(logs, weights, np.exp(u), known, mean)
        weights = [_weights(log, np.exp(u), log.T @ x) for log in logs]
        H, g = _system(logs, weights, u, x)
        H[:n, :n] += known
        g[:n] += known @ (mean - x)
        H[n:, n:] += np.eye(joints) / error**2
        g[n:] -= u / error**2
        at = np.array([*range(n), *(n + j for j in free)])
        step = np.zeros(joints)
        step[free] = _solved(H[np.ix_(at, at)], g[at])[n:]
        step *= min(1.0, LARGEST / max(np.max(np.abs(step)), TINY))
        u = u + step
        if np.max(np.abs(step)) < CLOSE:
            break
    return Gains(u, _covariance(logs, weights, u, x, H, at, free), x)


def _unknowns(
    logs: Sequence[Log], weights: Sequence[Array], k: Array, known: Array, mean: Array
) -> Array:
    """The unknowns, given the gains."""
    H, g = known.copy(), known @ mean
    for log, weight in zip(logs, weights, strict=True):
        A = log.products.values
        H += log.T.T @ np.tensordot(weight * k**2, A[:, :-1, :-1], 1) @ log.T
        g += log.T.T @ np.tensordot(weight * k, A[:, :-1, -1], 1)
    return _solved(H, g)


def _weights(log: Log, k: Array, theta: Array) -> Array:
    """The inverse variances of the residuals of each joint, of noise that is correlated in time."""
    A = log.products.values
    along = np.column_stack((-np.outer(k, theta), np.ones(len(k))))
    squares = np.einsum("ji,jik,jk->j", along, A, along)
    least = 1e-18 * A[:, -1, -1] + TINY
    variances = np.maximum(squares, least) * log.products.inflation
    return np.asarray(log.products.counts / variances)


def _system(
    logs: Sequence[Log], weights: Sequence[Array], u: Array, x: Array
) -> tuple[Array, Array]:
    """J'J and J' times the residuals, for the unknowns and the logarithms of the gains."""
    n, k = len(x), np.exp(u)
    H, g = np.zeros((n + len(u), n + len(u))), np.zeros(n + len(u))
    for log, weight in zip(logs, weights, strict=True):
        own, score = _of_log(log, weight, k, x)
        H += own
        g += score
    return H, g


def _of_log(log: Log, weight: Array, k: Array, x: Array) -> tuple[Array, Array]:
    A, T, n = log.products.values, log.T, len(x)
    theta, G, c = T @ x, A[:, :-1, :-1], A[:, :-1, -1]
    H, g = np.zeros((n + len(k), n + len(k))), np.zeros(n + len(k))
    Gtheta = G @ theta
    H[:n, :n] = T.T @ np.tensordot(weight * k**2, G, 1) @ T
    H[:n, n:] = T.T @ (weight * k**2 * Gtheta.T)
    H[n:, :n] = H[:n, n:].T
    H[n:, n:] = np.diag(weight * k**2 * (Gtheta @ theta))
    rest = k[:, None] * c - (k**2)[:, None] * Gtheta
    g[:n] = T.T @ (weight @ rest)
    g[n:] = weight * (rest @ theta)
    return H, g


def _covariance(
    logs: Sequence[Log],
    weights: Sequence[Array],
    u: Array,
    x: Array,
    H: Array,
    at: Array,
    free: list[int],
) -> Array:
    """The covariance of the logarithms: that of the noise, and the largest of the biases."""
    n, k = len(x), np.exp(u)
    inner = _solved(H[np.ix_(at, at)], np.eye(len(at)))
    found = np.zeros((len(k), len(k)))
    found[np.ix_(free, free)] = inner[n:, n:]
    for log, weight in zip(logs, weights, strict=True):
        shifts = np.zeros((len(log.judged.biases), len(k)))
        for row, bias in zip(shifts, log.judged.biases, strict=True):
            row[free] = (inner @ _moved(log, weight, k, x, bias)[at])[n:]
        found += np.diag(np.max(shifts**2, axis=0, initial=0.0))
    return found


def _moved(log: Log, weight: Array, k: Array, x: Array, bias: Array) -> Array:
    """J' times the torques of a bias of the parameters."""
    A, theta = log.products.values, log.T @ x
    torques = A[:, :-1, :-1] @ bias
    return np.concatenate(
        (log.T.T @ ((weight * k**2) @ torques), weight * k**2 * (torques @ theta))
    )


def _solved(H: Array, g: Array) -> Array:
    """H^-1 g for a positive semidefinite H, with unknowns of unlike units."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(H), TINY))
    values, vectors = np.linalg.eigh(H * np.outer(scale, scale))
    inverse = np.where(values > 1e-13 * values[-1], 1.0 / np.maximum(values, TINY), 0.0)
    return np.asarray((scale * ((vectors * inverse) @ (vectors.T @ (scale * g.T).T)).T).T)
