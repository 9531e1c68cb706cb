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
ROWS = 4000  # of the regressor at least, with fewer states for robots with many joints
STATE_RANGE = 3.0  # rad or m, and per s and s2
# Descriptions round angles to 1.5708 or 3.14159. What such an angle adds is 1e-5 at most; no log
# can show it, and among 75 URDFs every other rest is below 1e-9 or above 1e-2
# (docs/design/robots.md).
DEPENDENT = 1e-4  # of a column: what is left of it counts as nothing
NOTHING = 1e-5  # of the longest column: a column, or what is left of it, that counts as nothing
EXACT = 1e-9  # of a column: what is left of it where it is a combination of others
ROUNDING = 1e-12
MARGIN = 4  # rows per parameter at least
TOGETHER = 32  # columns that are projected at once, as products of matrices are faster
ABSENT = 1e-6  # factor of a parameter that is not part of a combination


def with_base_parameters(robot: Robot) -> Robot:
    """The robot with its base parameters only, each with the combination that it stands for."""
    rng = np.random.default_rng(0)
    motion = rng.uniform(-STATE_RANGE, STATE_RANGE, (3, len(robot.joints), RANDOM_STATES))
    joints = len(robot.joints)
    states = min(RANDOM_STATES, -(-max(ROWS, MARGIN * len(robot.parameters)) // joints))
    W = robot.regressor(*motion[:, :, :states]).reshape(-1, len(robot.parameters))
    kept, parts = independent(W)
    if not kept:
        raise ValueError("its torques depend on no parameter; correct its masses and lengths")
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
    W_dropped = W_kept B; it is zero for columns that are kept, and for those that count as nothing
    unless they are a combination of others to within rounding, as of a mass on a short lever.
    """
    lengths = np.linalg.norm(W, axis=0)
    nothing = NOTHING * lengths.max(initial=0.0)
    columns = np.flatnonzero(lengths > nothing)
    basis = np.empty((len(W), len(columns)), order="F")
    kept: list[int] = []
    for start in range(0, len(columns), TOGETHER):
        numbers = columns[start : start + TOGETHER]
        rests = _rest(W[:, numbers] / lengths[numbers], basis[:, : len(kept)])
        first = len(kept)
        for i, own in zip(numbers.tolist(), rests.T, strict=True):
            rest = _rest(own, basis[:, first : len(kept)])
            size = float(np.linalg.norm(rest))
            if size > max(DEPENDENT, nothing / lengths[i]):
                basis[:, len(kept)] = rest / size
                kept.append(i)
    # In the basis of the kept columns, the equations are as few as these are.
    small = basis[:, : len(kept)].T @ W
    rounding = np.finfo(np.float64).eps * len(W)
    parts: Array = np.asarray(np.linalg.lstsq(small[:, kept], small, rounding)[0], dtype=np.float64)
    parts[:, kept] = 0.0
    # What a rounded angle leaves of a column has a share of every other one, which says nothing.
    left = np.linalg.norm(W - W[:, kept] @ parts, axis=0)
    rounded = left > EXACT * lengths
    little = np.abs(parts) * lengths[kept][:, None] <= DEPENDENT * lengths
    parts[(little | (lengths <= nothing)) & rounded] = 0.0
    return kept, parts


def _rest(columns: Array, basis: Array) -> Array:
    """What the columns are beside their projection on the basis."""
    for _ in range(2):  # twice, for the digits that the first projection loses
        columns = columns - basis @ (basis.T @ columns)
    return columns
