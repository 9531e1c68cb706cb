"""How well predicted torques agree with measured ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.arrays import Array
from scarid_cli.kernels import moments

# Count, mean, squares about the mean, squared errors, squares: see the kernel.
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
    """r2: eq. 36, nan for a constant torque. rmse: eq. 35, in the torque's unit.

    relative_error: 100 |tau - tau_hat| / |tau| [%].
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
                r2=float(1.0 - errors / about) if about > 0.0 else float("nan"),
                rmse=float(np.sqrt(errors / count)),
                relative_error=float(100.0 * np.sqrt(errors / squares)),
                samples=int(count),
            )
