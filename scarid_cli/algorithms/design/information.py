"""The criterion of a curve as a function of its coefficients, with its gradient."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.design.aims import Columns
from scarid_cli.algorithms.design.criteria import Goal
from scarid_cli.algorithms.design.model import Motion
from scarid_cli.algorithms.trajectories.curve import Basis
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

STATES = 400  # all over the limits


@dataclass(frozen=True)
class Samples:
    """The functions of a basis and their derivatives (3, functions, samples) at some times."""

    home: Array
    values: Array

    @classmethod
    def of(cls, basis: Basis, home: Array, t: Array) -> Samples:
        return cls(home, np.array([basis.values(t, order) for order in range(3)]))

    def motion(self, coefficients: Array) -> Motion:
        q, dq, ddq = (coefficients @ values for values in self.values)
        return q + self.home[:, None], dq, ddq

    def pulled(self, slopes: Motion) -> Array:
        """The gradient by the coefficients, from those by q, dq and ddq."""
        pairs = zip(slopes, self.values, strict=True)
        total: Array = np.sum([slope @ values.T for slope, values in pairs], axis=0)
        return total


@dataclass(frozen=True)
class Experiment:
    """What is to be known: columns, the noise of torques, and what is known already.

    `weights` (joints) are the information of one sample, 1 / variance, times the samples of the
    log for each one that is computed here. `known` and `known_moments` (parameters, parameters)
    are the information from earlier experiments, and the same for torques of unit noise.
    """

    model: Columns
    goal: Goal
    weights: Array
    known: Array
    known_moments: Array

    def evaluate(self, samples: Samples, coefficients: Array) -> tuple[float, Array]:
        """The criterion, and its gradient by the coefficients (joints, functions)."""
        motion = samples.motion(coefficients)
        W = self.model.regressor(motion)
        columns = W.shape[2]
        rows = W.reshape(-1, columns)
        scaled = (W * self.weights[:, None]).reshape(-1, columns)
        value, by_moments, by_information = self.goal.of(
            rows.T @ rows + self.known_moments, scaled.T @ rows + self.known
        )
        G = 2.0 * (rows @ by_moments + scaled @ by_information)
        return value, samples.pulled(self.model.gradient(motion, G.reshape(W.shape)))


def typical_moments(model: Columns, limits: Limits) -> Array:
    """The mean of W'W over random states within the limits (columns, columns).

    The states are always the same.
    """
    rng = np.random.default_rng(0)
    shape = (len(limits.dq), STATES)
    q = rng.uniform(limits.lower[:, None], limits.upper[:, None], shape)
    dq, ddq = (x[:, None] * rng.uniform(-1.0, 1.0, shape) for x in (limits.dq, limits.ddq))
    W = model.regressor((q, dq, ddq))
    rows = W.reshape(-1, W.shape[2])
    moments: Array = rows.T @ rows / STATES
    return moments
