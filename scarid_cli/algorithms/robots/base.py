"""Base parameters: the fewest that the torques depend on (Gautier 1991, by QR decomposition).

Columns of the regressor along random motions, one after the other: one that the columns before it
make up is left out, and its parameter counted to theirs. The motions are always the same, so the
set is too. Its a priori values are those of the same torques.
"""

from __future__ import annotations

from dataclasses import replace
from math import fsum

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array

SAMPLES = 400
REACH = 3.0  # rad or m, and per s and s2
DEPENDENT = 1e-8  # of a column of unit length
NONE = 1e-12  # of the longest column: rounding alone
ROUNDING = 1e-12
ABSENT = 1e-6  # times its neighbour: not a part of a combination


def with_base_parameters(robot: Robot) -> Robot:
    """The robot with its base parameters alone, each written out in those it stands for."""
    rng = np.random.default_rng(0)
    motion = rng.uniform(-REACH, REACH, (3, len(robot.joints), SAMPLES))
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
    """Without the rounding that is left where all of it cancels."""
    total = fsum(values)
    return total if abs(total) > ROUNDING * fsum(map(abs, values)) else 0.0


def independent(W: Array) -> tuple[list[int], Array]:
    """The columns that those before them do not make up, and how they make up the others.

    The second (kept columns, columns) has zeros where a column is kept or always zero.
    """
    lengths = np.linalg.norm(W, axis=0)
    basis = np.empty((len(W), 0))
    kept: list[int] = []
    for i, length in enumerate(lengths):
        if not length > NONE * lengths.max():
            continue
        rest = W[:, i] / length
        for _ in range(2):  # once more, for the digits that the first projection loses
            rest = rest - basis @ (basis.T @ rest)
        size = float(np.linalg.norm(rest))
        if size > DEPENDENT:
            basis = np.column_stack((basis, rest / size))
            kept.append(i)
    parts: Array = np.asarray(np.linalg.lstsq(W[:, kept], W, rcond=None)[0], dtype=np.float64)
    parts[:, kept] = 0.0
    return kept, parts
