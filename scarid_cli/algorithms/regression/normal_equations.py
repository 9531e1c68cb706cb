"""Normal equations whose columns may have any units, and may be undetermined."""

from __future__ import annotations

import numpy as np

from scarid_cli.arrays import Array

FLAT = 1e-10  # of the largest eigenvalue: directions below it are not in the motion


def solved(gram: Array, right: Array) -> Array:
    """The solution of normal equations, 0 along directions that they leave undetermined."""
    found: Array = inverse(gram) @ right
    return found


def inverse(gram: Array) -> Array:
    """The pseudo-inverse of a Gram matrix whose columns may have any units."""
    whitening, _ = roots(gram)
    found: Array = whitening @ whitening.T
    return found


def roots(gram: Array) -> tuple[Array, Array]:
    """V and U with V' gram V = 1, U V' = 1 and U U' = gram (columns, rank), in any units.

    Directions that the Gram matrix leaves undetermined are left out.
    """
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    kept = values > FLAT * values[-1]
    root = np.sqrt(values[kept])
    return vectors[:, kept] / root / size[:, None], vectors[:, kept] * root * size[:, None]
