"""Base parameters: the smallest set that the torques depend on (Gautier 1991, by QR).

The columns of the regressor are computed at random samples and taken in order. A column that is a
linear combination of the columns before it is dropped, and its parameter is added to theirs. The
random samples are always the same, and so is the set (docs/theory.md, "Base parameters").
"""

from __future__ import annotations

from dataclasses import replace
from math import fsum

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

RANDOM_STATES = 400
STATE_RANGE = 3.0  # rad or m, and per s and s2
DEPENDENT = 1e-8  # rest of a column of unit length that counts as none
ZERO_COLUMN = 1e-12  # times the longest column: a column that is rounding alone
ROUNDING = 1e-12
ABSENT = 1e-6  # factor of a parameter that is not part of a combination


def with_base_parameters(robot: Robot) -> Robot:
    """The robot with its base parameters only, each with the combination that it stands for."""
    rng = np.random.default_rng(0)
    motion = rng.uniform(-STATE_RANGE, STATE_RANGE, (3, len(robot.joints), RANDOM_STATES))
    W = robot.regressor(*motion).reshape(-1, len(robot.parameters))
    kept, parts = independent(W)
    parameters = []
    for row, i in enumerate(kept):
        own = robot.parameters[i]
        others = [
            (x, p) for x, p in zip(parts[row], robot.parameters, strict=True) if abs(x) > ABSENT
        ]
        apriori = _sum([own.apriori, *(float(x) * p.apriori for x, p in others)])
        counted = ((own.name, 1.0), *((p.name, float(x)) for x, p in others))
        parameters.append(replace(own, apriori=apriori, parts=counted))
    return replace(robot, parameters=tuple(parameters))


def _sum(values: list[float]) -> float:
    """The sum, or 0 where the terms cancel to within rounding."""
    total = fsum(values)
    return total if abs(total) > ROUNDING * fsum(map(abs, values)) else 0.0


def independent(W: Array) -> tuple[list[int], Array]:
    """The columns that are independent of those before them, and the others in terms of them.

    W is (rows, columns). The second result B (kept columns, columns) gives the dropped columns,
    W_dropped = W_kept B; it is zero for columns that are kept or always zero.
    """
    lengths = np.linalg.norm(W, axis=0)
    basis = np.empty((len(W), 0))
    kept: list[int] = []
    for i, length in enumerate(lengths):
        if not length > ZERO_COLUMN * lengths.max():
            continue
        rest = W[:, i] / length
        for _ in range(2):  # twice, for the digits that the first projection loses
            rest = rest - basis @ (basis.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > DEPENDENT:
            basis = np.column_stack((basis, rest / size))
            kept.append(i)
    parts: Array = np.asarray(np.linalg.lstsq(W[:, kept], W, rcond=None)[0], dtype=np.float64)
    parts[:, kept] = 0.0
    return kept, parts
