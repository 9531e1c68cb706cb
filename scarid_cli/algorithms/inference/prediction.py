"""How well predicted torques agree with measured ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array, varies
from scarid_cli.kernels import moments

# Count, mean, sums of squares about the mean, of errors and of torques (see kernels/moments.py).
SUMS = 5


def empty() -> Array:
    """The sums before the first sample."""
    return np.zeros(SUMS)


def accumulate(sums: Array, measured: Array, predicted: Array) -> Array:
    """The sums after these samples of one joint."""
    sums = sums.copy()
    moments.accumulate(np.ascontiguousarray(measured), predicted, sums)
    return sums


@dataclass(frozen=True)
class Quality:
    """How well predicted torques of one joint agree with the measured ones.

    `r2` is that of paper eq. 36, nan for a constant torque; `rmse` that of eq. 35, in the unit of
    the torque; `relative_error` is 100 |tau - tau_hat| / |tau| [%].
    """

    r2: float
    rmse: float
    relative_error: float
    samples: int

    @classmethod
    def of(cls, sums: Array) -> Quality:
        count, _, about, errors, squares = sums
        with np.errstate(divide="ignore", invalid="ignore"):
            return cls(
                r2=float(1.0 - errors / about) if varies(about, squares) else float("nan"),
                rmse=float(np.sqrt(errors / count)),
                relative_error=float(100.0 * np.sqrt(errors / squares)),
                samples=int(count),
            )
