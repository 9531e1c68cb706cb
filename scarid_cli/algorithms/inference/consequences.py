"""What the uncertainty of the estimates means for their use: torques and inertias.

An arm of fifty parameters has some that its motion hardly determines, and that matter as little.
What matters is whether the torque is predicted within its noise where the parameters were not
fitted, and how well the torque and the inertia of each joint are known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.jackknife import regular
from scarid_cli.arrays import Array, median

PARTS = 10  # of the record, each left out once
NOTHING = 1e-4  # of a torque: no sensor shows as little
POSES = 50  # of the record, at which the inertia is computed


@dataclass(frozen=True)
class Consequences:
    """How well torques and inertias are known; one value for each joint, but for `parts`.

    `held_out` is the root-mean-square residual of parts of the record that were left out of the
    fit, divided by that of the fit itself. `torque` is the standard error of the predicted torque,
    divided by the root-mean-square torque, and `noise` the part of it that is due to noise alone,
    which a longer log would reduce. `diagonal` is the diagonal of the inertia matrix [kg m2 or kg],
    and `inertia` its standard error, divided by it, as medians over poses of the record. `parts`
    (own parameters) is the part of the torque that each parameter has per unit, at the joint where
    it is greatest.
    """

    held_out: Array
    torque: Array
    noise: Array
    diagonal: Array
    inertia: Array
    parts: Array

    @property
    def negligible(self) -> Array:
        """By how much each parameter may change without a torque that any sensor shows."""
        with np.errstate(divide="ignore"):
            return np.asarray(NOTHING / self.parts)


@dataclass(frozen=True)
class Uncertainty:
    """The uncertainty of the first `own` estimates.

    `torque` (own, own) is the covariance of what matters for the torque on this motion, and `noise`
    (own, own) that of the noise alone. `biases` (alternatives, own) are moves of the estimates that
    leave the torque on this motion as it is.
    """

    torque: Array
    noise: Array
    biases: Array


def consequences(
    record: Blocks,
    fitted: Blocks,
    weights: Array,
    estimates: Array,
    uncertainty: Uncertainty,
    model: Model | None,
    poses: Array,
) -> Consequences:
    """What the uncertainty means at these poses (joints, samples) [rad or m].

    `fitted` has the rows as they were fitted, those of `record` or these whitened in time.
    """
    torque, noise = (_torque(record.total, x) for x in (uncertainty.torque, uncertainty.noise))
    diagonal, inertia = np.full((2, len(weights)), np.nan)
    if model is not None and poses.size:
        own = estimates[: len(uncertainty.torque)]
        diagonal, inertia = _inertia(model, own, uncertainty, poses)
    held_out = _held_out(record, fitted, weights, estimates)
    parts = _parts(record.total, len(uncertainty.torque))
    return Consequences(held_out, torque, noise, diagonal, inertia, parts)


def _held_out(record: Blocks, fitted: Blocks, weights: Array, estimates: Array) -> Array:
    """Residuals of parts that were left out, relative to those of the fit (joints)."""
    inside = _squares(record.total, estimates)
    outside = held_out_squares(record, weights, fitted).sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sqrt(np.where(outside > 0.0, outside / inside, 1.0)))


def held_out_squares(
    record: Blocks, weights: Array, fitted: Blocks | None = None, parts: int = PARTS
) -> Array:
    """The residual sums of squares (parts, joints) of parts that were left out of the fit.

    Rows of the joints are multiplied by `weights` (joints); inf where the rest does not determine
    the estimates.
    """
    fitted = fitted or record
    total, found = fitted.total, []
    for part, left_out in zip(record.grouped(parts), fitted.grouped(parts), strict=False):
        rest = np.tensordot(weights**2, total - left_out, 1)
        gram = rest[:-2, :-2]
        if regular(gram):
            found.append(_squares(part, np.asarray(np.linalg.solve(gram, rest[:-2, -2]))))
        else:
            found.append(np.full(len(weights), np.inf))
    return np.array(found)


def _squares(products: Array, estimates: Array) -> Array:
    """The residual sum of squares of each joint (joints), from the products of [W, y, 1]."""
    along = np.concatenate((-estimates, [1.0, 0.0]))
    squares = np.einsum("i,jik,k->j", along, products, along)
    return np.asarray(np.maximum(squares, 0.0), dtype=np.float64)


def _torque(products: Array, covariance: Array) -> Array:
    """The error of the predicted torque, relative to the torque (joints)."""
    own = len(covariance)
    errors = np.einsum("ik,jki->j", covariance, products[:, :own, :own])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sqrt(np.maximum(errors, 0.0) / products[:, -2, -2]))


def _parts(products: Array, own: int) -> Array:
    """The root mean square of each column over that of the torque, the largest of all joints."""
    squares = np.diagonal(products, axis1=1, axis2=2)
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.sqrt(squares[:, :own] / squares[:, -2:-1])
    return np.asarray(np.max(np.nan_to_num(parts, nan=0.0), axis=0))


def _inertia(
    model: Model, estimates: Array, uncertainty: Uncertainty, poses: Array
) -> tuple[Array, Array]:
    """The diagonal of the inertia matrix, and its error relative to it (joints).

    The largest of the biases counts, as for the errors of the estimates.
    """
    values, found = [], []
    for rows in model.inertias(few(poses)):
        squares = np.maximum(np.einsum("si,ik,sk->s", rows, uncertainty.torque, rows), 0.0)
        largest = np.max((uncertainty.biases @ rows.T) ** 2, axis=0, initial=0.0)
        errors, value = np.sqrt(squares + largest), rows @ estimates
        with np.errstate(divide="ignore", invalid="ignore"):
            found.append(median(errors / np.abs(value)))
        values.append(median(value))
    return np.array(values), np.array(found)


def few(poses: Array) -> Array:
    """Some of the poses (joints, samples) of a record, all along it."""
    return np.ascontiguousarray(poses[:, :: max(1, poses.shape[1] // POSES)])


def gain_sensitivities(total: Array, weights: Array) -> Array:
    """How far the estimates move per relative change of each torque constant (joints, columns).

    If the torque of joint j is logged too large by a factor 1 + g, W'S y gains g times the part of
    that joint, so d theta / d g = (W'S W)^-1 W_j' S_j y_j. All joints together give theta itself.
    total: the products of [W, y, 1] of all rows.
    """
    parts = (weights**2)[:, None, None] * total
    gram = parts.sum(axis=0)[:-2, :-2]
    if not regular(gram):
        return np.full((len(weights), len(gram)), np.nan)
    return np.asarray(np.linalg.solve(gram, parts[:, :-2, -2].T).T)
