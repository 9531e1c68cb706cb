"""What a motion will tell about the parameters, before anything moves.

The rows of the log are weighted by the known noise of each joint, which is white; the regressor is
exact. The covariance of the parameters is then the inverse of the information (paper eq. 33).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.robots.description import Parameter
from scarid_cli.arrays import Array

UNDETERMINED = 1e-12  # an eigenvalue of the scaled information that counts as none
SHARE = 1e-6  # of a parameter in such a direction that makes the parameter unknown
KNOWN_WITHIN = 0.3  # as the verdict of `identify` says


@dataclass(frozen=True)
class Moments:
    """W'W over the rows of each joint (joints, parameters, parameters), and their number."""

    of_joints: Array
    rows: int

    @classmethod
    def of(cls, regressors: Iterable[Array]) -> Moments:
        """From the regressors of batches of rows (samples, joints, parameters)."""
        total, rows = np.zeros(()), 0
        for W in regressors:
            total = total + np.einsum("kji,kjl->jil", W, W, optimize=True)
            rows += len(W)
        return cls(total, rows)

    def information(self, noise: Array) -> Array:
        """The information for torques with white noise of these deviations (joints) [N m or N]."""
        information: Array = np.tensordot(noise**-2.0, self.of_joints, axes=1)
        return information

    @property
    def conditions(self) -> tuple[float, float]:
        """The condition numbers of W and of its columns divided by their lengths."""
        whole = self.of_joints.sum(axis=0)
        return _condition(whole), _condition(_scaled(whole)[0])


def _condition(moments: Array) -> float:
    values = np.linalg.eigvalsh(moments)
    return float(np.sqrt(values[-1] / values[0])) if values[0] > 0.0 else float("inf")


def _scaled(matrix: Array) -> tuple[Array, Array]:
    """The matrix with a diagonal of ones, and the roots of its own diagonal."""
    lengths = np.sqrt(np.diag(matrix))
    safe = np.where(lengths > 0.0, lengths, 1.0)
    return matrix / np.outer(safe, safe), lengths


def standard_errors(information: Array) -> Array:
    """The standard errors (parameters); infinite for those that the motion does not determine."""
    scaled, lengths = _scaled(information)
    values, vectors = np.linalg.eigh(scaled)
    weak = values < UNDETERMINED * values[-1]
    known = (vectors[:, weak] ** 2).sum(axis=1) < SHARE
    variances = (vectors[:, ~weak] ** 2 / values[~weak]).sum(axis=1)
    known &= lengths > 0.0
    errors = np.full(len(information), np.inf)
    errors[known] = np.sqrt(variances[known]) / lengths[known]
    return errors


def logarithm(information: Array) -> float:
    """The logarithm of the determinant of the information, per parameter."""
    return float(np.linalg.slogdet(information)[1]) / len(information)


def relative(errors: Array, parameters: tuple[Parameter, ...]) -> Array:
    """Errors relative to a priori values; nan where these are zero."""
    apriori = np.array([abs(parameter.apriori) for parameter in parameters])
    found: Array = np.divide(errors, apriori, out=np.full(len(errors), np.nan), where=apriori > 0.0)
    return found


def unknown(errors: Array, parameters: tuple[Parameter, ...]) -> list[str]:
    """The parameters that stay unknown.

    Their error is above 30 % of the a priori value, or where this is zero, of the largest one with
    the same unit.
    """
    largest: dict[str, float] = {}
    for p in parameters:
        largest[p.unit] = max(largest.get(p.unit, 0.0), abs(p.apriori))
    found = []
    for p, error in zip(parameters, errors.tolist(), strict=True):
        size = abs(p.apriori) or largest[p.unit]
        if np.isinf(error) or (size and error > KNOWN_WITHIN * size):
            found.append(p.name)
    return found
