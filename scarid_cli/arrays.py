"""The array types of the project: doubles, as the kernels take them, whole numbers and marks."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int64]
Marks = npt.NDArray[np.bool_]

CONSTANT = 1e-12  # share of the mean square, below which a variance is rounding


def varies(about: Array | float, squares: Array | float) -> Marks:
    """Whether values with these squares about their mean, and about zero, are not constant."""
    return np.asarray(about > CONSTANT * np.asarray(squares))


def spread_starts(rows: int, length: int, count: int) -> Numbers:
    """The first rows of so many blocks of this length, spread evenly over all rows."""
    return np.arange(count) * (rows - length) // max(1, count - 1)


def median(values: Array) -> float:
    """The median of a vector, as numpy's, which would import numpy.ma; nan if a value is nan."""
    ordered = np.sort(values)
    if not len(ordered) or np.isnan(ordered[-1]):
        return float("nan")
    middle = len(ordered) // 2
    low = ordered[middle - 1 + len(ordered) % 2]
    return float((low + ordered[middle]) / 2.0)
