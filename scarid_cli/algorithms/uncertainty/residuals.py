"""The residual of each joint, and how well the model explains the joint's torque."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.lasting import lasting
from scarid_cli.algorithms.uncertainty.peaks import peaks_of
from scarid_cli.arrays import Array, Marks, varies


@dataclass(frozen=True)
class JointResidual:
    """Statistics of the residual rho of one joint, over its fitted `rows`.

    `r2` is that of paper eq. 36. `deviation` (the root-mean-square residual) and `torque` (the
    root-mean-square torque) are in N m or N; `relative_error` is 100 |rho| / |tau| [%]. The
    `autocorrelation` from one sample to the next and the excess `kurtosis` are 0 for white normal
    noise. `peak` and `peak_scale` [N m or N] are the mode and the scale of its largest values in
    half a second (peaks.py). `lasting` [N m or N] is what the model lacks in it (lasting.py).
    """

    rows: int
    r2: float
    deviation: float
    relative_error: float
    autocorrelation: float
    kurtosis: float
    torque: float
    peak: float = float("nan")
    peak_scale: float = float("nan")
    lasting: float = float("nan")


def residuals(
    rows: Rows, estimates: Array, record: Blocks | None = None, fitted: Array | None = None
) -> tuple[JointResidual, ...]:
    """The residual of each joint behind these estimates; what lasts is that behind those `fitted`.

    If `rows` are a subsample of a longer `record`, sums of squares are those of the whole record.
    """
    left = rows.y - rows.W @ estimates
    lasts = lasting(left if fitted is None else rows.y - rows.W @ fitted, rows)
    joints = [
        replace(_joint(rows.y[:, j], left[:, j], rows.scales[:, j] > 0.0, rows), lasting=x)
        for j, x in enumerate(lasts.tolist())
    ]
    if record is None:
        return tuple(joints)
    pairs = zip(joints, record.total, strict=True)
    return tuple(_over_all_rows(joint, products, estimates) for joint, products in pairs)


def _over_all_rows(joint: JointResidual, products: Array, estimates: Array) -> JointResidual:
    """The residual with the sums of all rows, from the products of [W, y, 1]."""
    along = np.concatenate((-estimates, [1.0, 0.0]))
    rows, total, squares = products[-1, -1], products[-1, -2], products[-2, -2]
    if not rows > 1.0:
        return joint
    left = max(float(along @ products @ along), 0.0)
    about = squares - total**2 / rows
    return replace(
        joint,
        rows=int(rows),
        r2=float(1.0 - left / about) if varies(about, squares) else float("nan"),
        deviation=float(np.sqrt(left / rows)),
        relative_error=float(100.0 * np.sqrt(left / squares)) if squares > 0.0 else float("nan"),
        torque=float(np.sqrt(squares / rows)),
    )


def _joint(y: Array, residual: Array, counts: Marks, rows: Rows) -> JointResidual:
    y, r, at = y[counts], residual[counts], rows.at[counts]
    nan = float("nan")
    if len(y) < 2:
        return JointResidual(len(y), nan, nan, nan, nan, nan, nan)
    about = float(np.sum((y - y.mean()) ** 2))
    squares = float(r @ r)
    next_to = np.diff(at) == 1
    spread = float(np.std(r))
    peaks = peaks_of(r, at, rows.h)
    with np.errstate(divide="ignore", invalid="ignore"):
        return JointResidual(
            rows=len(y),
            r2=1.0 - squares / about if varies(about, float(y @ y)) else nan,
            deviation=float(np.sqrt(squares / len(r))),
            relative_error=float(100.0 * np.sqrt(squares / (y @ y))) if np.any(y) else nan,
            autocorrelation=float(np.sum((r[1:] * r[:-1])[next_to]) / squares) if squares else 0.0,
            kurtosis=float(np.mean(((r - r.mean()) / spread) ** 4) - 3.0) if spread else 0.0,
            torque=float(np.sqrt(np.mean(y * y))),
            peak=peaks.mode,
            peak_scale=peaks.scale,
        )
