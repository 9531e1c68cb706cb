"""Minimisation under constraints by an augmented Lagrangian (Nocedal and Wright 2006, chap. 17)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from scarid_cli.algorithms.design.constraints import Constraint
from scarid_cli.arrays import Array

Objective = Callable[[Array], tuple[float, Array]]


@dataclass(frozen=True)
class Lagrangian:
    """An objective with constraints, a penalty on their violations, and their multipliers."""

    objective: Objective
    constraints: Sequence[Constraint]
    penalty: float
    multipliers: Sequence[Array | float]

    def evaluate(self, coefficients: Array) -> tuple[float, Array]:
        """Its value and gradient."""
        value, slope = self.objective(coefficients)
        for constraint, multiplier in zip(self.constraints, self.multipliers, strict=True):
            violations, pull = constraint.evaluate(coefficients)
            pressed = np.maximum(self.penalty * violations + multiplier, 0.0)
            if pressed.any():
                value += 0.5 * float((pressed**2).sum()) / self.penalty
                slope = slope + pull(pressed)
        return value, slope

    def updated(self, coefficients: Array) -> list[Array | float]:
        """The multipliers at the minimum of this function."""
        pairs = zip(self.constraints, self.multipliers, strict=True)
        return [
            np.maximum(self.penalty * constraint.evaluate(coefficients)[0] + multiplier, 0.0)
            for constraint, multiplier in pairs
        ]


def minimised(
    objective: Objective,
    constraints: Sequence[Constraint],
    start: Array,
    scales: Array,
    penalties: Sequence[float],
    iterations: int,
) -> Array:
    """Coefficients (joints, functions) that minimise an objective and nearly keep constraints.

    With each penalty there are so many iterations of L-BFGS, and then new multipliers. `scales`
    (joints) are sizes of the coefficients.
    """
    coefficients = start
    multipliers: list[Array | float] = [0.0] * len(constraints)
    sizes = scales[:, None]
    for penalty in penalties:
        active = [constraint.watched(coefficients) for constraint in constraints]
        function = Lagrangian(objective, active, penalty, multipliers)
        coefficients = sizes * _minimum(function, coefficients / sizes, sizes, iterations)
        multipliers = function.updated(coefficients)
    return coefficients


def _minimum(function: Lagrangian, start: Array, sizes: Array, iterations: int) -> Array:
    def scaled(x: Array) -> tuple[float, Array]:
        value, slope = function.evaluate(sizes * x.reshape(start.shape))
        return value, (sizes * slope).ravel()

    options = {"maxiter": iterations}
    found = minimize(scaled, start.ravel(), jac=True, method="L-BFGS-B", options=options)
    least: Array = found.x.reshape(start.shape)
    return least
