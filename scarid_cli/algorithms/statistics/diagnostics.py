"""Whether to believe a fit: errors that autocorrelated residuals cannot shrink, and its residual.

The errors are from all rows, the rest from rows that stand for them where these are too many.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from scarid_cli.algorithms.regression.information import (
    Fit,
    NotIdentifiableError,
    least_squares,
)
from scarid_cli.algorithms.regression.rows import Rows, runs, with_delay, without_slow
from scarid_cli.algorithms.statistics.blocks import Blocks
from scarid_cli.arrays import Array, Marks, Numbers

BLOCK = 0.5  # s: residuals so far apart are taken to be independent
BLOCKS = (10, 128)  # of a record at least, and at most
LAG = 0.025  # s: what soft sensors delay
PIECE = 1024  # samples that are worked on at once
SLOW = 0.1  # of the usual velocity
FLAT = 1e-9  # of the greatest eigenvalue: directions that the lagged motion does not have
Z95 = 1.959963984540054


@dataclass(frozen=True)
class Joint:
    """The residual of one joint: R2 (eq. 36) and deviation over the rows that counted.

    `autocorrelation` from one sample to the next and excess `kurtosis`: 0 for white normal noise.
    `relative_error` is 100 |rho| / |tau| [%], `torque` the root-mean-square torque.
    """

    rows: int
    r2: float
    deviation: float
    relative_error: float
    autocorrelation: float
    kurtosis: float
    torque: float


@dataclass(frozen=True)
class Diagnostics:
    """What the residuals say of a fit.

    `errors` are standard errors robust to autocorrelation, `quantile` times which is half of a 95 %
    interval; `lag_share` is the part of the residual that the motion 25 ms before and after
    explains: near 0 if all signals belong to the same instant, near 1 if they do not. `moved` is by
    how many errors the estimates move if the rows slower than `slow` (joints) [rad/s or m/s] are
    left out and a delay of the torques is fitted as well.
    """

    errors: Array
    quantile: float
    joints: tuple[Joint, ...]
    lag_share: float
    moved: Array
    slow: Array


def diagnose(
    rows: Rows, fit: Fit, h: float, parameters: int, record: Blocks | None = None
) -> Diagnostics:
    """From rows every h [s], and the blocks of the `record` if there are more rows than these.

    `parameters`: how many of the columns are the robot's; the others are nuisances.
    """
    joints = _joints(rows, fit)
    if record:
        covariance, blocks = _scatter(_without_each(_parts_of(record, rows, fit, h)))
    else:
        covariance, blocks = jackknife(rows, fit, h)
    errors: Array = np.sqrt(np.diag(covariance))
    slow = SLOW * np.sqrt(np.mean(rows.motion[1] ** 2, axis=1))
    fast = without_slow(rows, slow)
    other = with_delay_fitted(fast, fit, h, joints, parameters)
    return Diagnostics(
        errors=errors,
        quantile=t95(blocks - 1),
        joints=joints,
        lag_share=lag_share(fast, h, joints, parameters),
        moved=(other - fit.estimates[:parameters]) / errors[:parameters],
        slow=slow,
    )


def with_delay_fitted(
    rows: Rows, fit: Fit, h: float, joints: tuple[Joint, ...], parameters: int
) -> Array:
    """The estimates with the delay of the torques fitted as well; nan if that is singular."""
    own = replace(rows, W=rows.W[:, :, :parameters])
    wide = with_delay(own, fit.estimates[:parameters], h)
    weights = np.array([1.0 / j.deviation if j.deviation > 0.0 else 0.0 for j in joints])
    try:
        fitted = least_squares(wide.W, wide.y, rows.scales * weights)
        return fitted.estimates[:parameters]
    except NotIdentifiableError:
        return np.full(parameters, np.nan)


def jackknife(rows: Rows, fit: Fit, h: float) -> tuple[Array, int]:
    """Covariance of the estimates by leaving out blocks of half a second, and their number.

    To first order in the scores of a block, with its leverage (the "CR3" of clustered errors; Bell
    and McCaffrey 2002), so that a few violent moves that carry an estimate widen its error.
    """
    return _scatter(shifts(rows, fit, h))


def _scatter(moved: Array) -> tuple[Array, int]:
    blocks, p = moved.shape
    if blocks < 2 or not np.isfinite(moved).all():
        return np.full((p, p), np.nan), max(blocks, 2)
    return (blocks - 1) / blocks * moved.T @ moved, blocks


def shifts(rows: Rows, fit: Fit, h: float) -> Array:
    """How far the estimates move without each block (blocks, parameters)."""
    first, last = rows.at[0], rows.at[-1] + 1
    count = _count((last - first) * h)
    block = (rows.at - first) * count // (last - first)
    edges = np.searchsorted(block, np.arange(count + 1))
    return _without_each([products(rows, fit, slice(a, b)) for a, b in pairwise(edges) if b > a])


def _count(duration: float) -> int:
    """Of the blocks of a record [s]."""
    return int(np.clip(round(duration / BLOCK), *BLOCKS))


def _parts_of(record: Blocks, rows: Rows, fit: Fit, h: float) -> list[tuple[Array, Array]]:
    """W'W and W'rho of each block; `fit` whitens by weights of the joints, if at all."""
    weights = np.ones(rows.y.shape[1])
    if fit.whitening is not None:
        weights = np.diag(fit.whitening) ** 2
    parts = []
    for products_of_joints in record.grouped(_count((rows.at[-1] - rows.at[0]) * h)):
        total = np.tensordot(weights, products_of_joints, 1)
        gram = total[:-1, :-1]
        parts.append((gram, total[:-1, -1] - gram @ fit.estimates))
    return parts


def _without_each(parts: list[tuple[Array, Array]]) -> Array:
    p = len(parts[0][1])
    total = sum((gram for gram, _ in parts), np.zeros((p, p)))
    moved = np.full((len(parts), p), np.inf)
    for i, (gram, score) in enumerate(parts):
        if _regular(total - gram):
            moved[i] = np.linalg.solve(total - gram, score)
    return moved


def _regular(gram: Array) -> bool:
    size = np.sqrt(np.abs(np.diag(gram)))
    if not np.all(size > 0.0):
        return False
    return bool(np.linalg.cond(gram / np.outer(size, size)) < 1e14)


def products(rows: Rows, fit: Fit, chosen: slice) -> tuple[Array, Array]:
    """Z'W and Z'rho of some samples, whitened; Z is W unless the fit has instruments."""
    part = rows.part(chosen)
    W, residual = _whitened(part, fit)
    weights = np.minimum(1.0, fit.huber / np.maximum(np.abs(residual), 1e-300))
    left = W
    if fit.instruments is not None:
        left = _times(fit.instruments[chosen], part.scales, fit.whitening)
    flat = (left * weights[:, :, None]).reshape(-1, W.shape[2])
    return flat.T @ W.reshape(-1, W.shape[2]), flat.T @ residual.ravel()


def _whitened(rows: Rows, fit: Fit) -> tuple[Array, Array]:
    residual = rows.y - rows.W @ fit.estimates
    scaled = _times(residual[:, :, None], rows.scales, fit.whitening)[:, :, 0]
    return _times(rows.W, rows.scales, fit.whitening), scaled


def _times(W: Array, scales: Array, whitening: Array | None) -> Array:
    """Each sample's rows times its scales, then mixed as the fit did."""
    scaled = W * scales[:, :, None]
    if whitening is None:
        return scaled
    if np.count_nonzero(whitening - np.diag(np.diag(whitening))):
        scaled = scaled * np.all(scales > 0.0, axis=1).reshape(-1, 1, 1)
    mixed: Array = np.einsum("ij,kjp->kip", whitening, scaled)
    return mixed


def _joints(rows: Rows, fit: Fit) -> tuple[Joint, ...]:
    residual = rows.y - rows.W @ fit.estimates
    return tuple(
        _joint(rows.y[:, j], residual[:, j], rows.scales[:, j] > 0.0, rows.at)
        for j in range(rows.y.shape[1])
    )


def _joint(y: Array, residual: Array, counts: Marks, at: Numbers) -> Joint:
    y, r, at = y[counts], residual[counts], at[counts]
    nan = float("nan")
    if len(y) < 2:
        return Joint(len(y), nan, nan, nan, nan, nan, nan)
    about = float(np.sum((y - y.mean()) ** 2))
    squares = float(r @ r)
    next_to = np.diff(at) == 1
    spread = float(np.mean((r - r.mean()) ** 2))
    with np.errstate(divide="ignore", invalid="ignore"):
        return Joint(
            rows=len(y),
            r2=1.0 - squares / about if about > 0.0 else nan,
            deviation=float(np.sqrt(squares / len(r))),
            relative_error=float(100.0 * np.sqrt(squares / (y @ y))) if np.any(y) else nan,
            autocorrelation=float(np.sum((r[1:] * r[:-1])[next_to]) / squares) if squares else 0.0,
            kurtosis=float(np.mean((r - r.mean()) ** 4) / spread**2 - 3.0) if spread else 0.0,
            torque=float(np.sqrt(np.mean(y * y))),
        )


def lag_share(rows: Rows, h: float, joints: tuple[Joint, ...], parameters: int) -> float:
    """The part of the residual that W a lag earlier and later explains, joints weighted alike.

    Of rows that are not slow: what dry friction does at rest is another matter.

    Torques and derivatives that belong to different instants, or derivatives that are mostly noise,
    make the neighbours of a row say more of its torque than the row itself.
    """
    lag = max(1, round(LAG / h))
    weights = np.array([1.0 / j.deviation if j.deviation > 0.0 else 0.0 for j in joints])
    p = rows.W.shape[2]
    total = np.zeros((p + 2 * parameters + 1,) * 2)
    for run in runs(rows.at):
        for part in _pieces(rows.part(run), lag):
            wide = _lagged(part, lag, weights, parameters)
            total += wide.T @ wide
    if not total[-1, -1] > 0.0:
        return 0.0
    own = [*range(p), -1]
    plain = _unexplained(total[np.ix_(own, own)])
    return 1.0 - _unexplained(total) / plain if plain > 0.0 else 0.0


def _pieces(rows: Rows, lag: int) -> Iterator[Rows]:
    """Parts that overlap by the lag on both sides."""
    for start in range(0, rows.samples, PIECE):
        part = rows.part(slice(max(0, start - lag), start + PIECE + lag))
        if part.samples > 2 * lag:
            yield part


def _lagged(rows: Rows, lag: int, weights: Array, parameters: int) -> Array:
    """Rows of [W, W before - W, W after - W, y], of the samples that have both neighbours."""
    inner = slice(lag, rows.samples - lag)
    W, own = rows.W[inner], rows.W[inner, :, :parameters]
    before = rows.W[: -2 * lag, :, :parameters] - own
    after = rows.W[2 * lag :, :, :parameters] - own
    wide = np.concatenate((W, before, after, rows.y[inner, :, None]), axis=2)
    wide *= (rows.scales[inner] * weights)[:, :, None]
    return wide.reshape(-1, wide.shape[2])


def _unexplained(moments: Array) -> float:
    """Sum of squares of the last column that the others leave, from the products of all."""
    gram, with_y = moments[:-1, :-1], moments[:-1, -1]
    size = np.sqrt(np.diag(gram))
    size[size == 0.0] = 1.0
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    kept = values > FLAT * values[-1]
    along = vectors[:, kept].T @ (with_y / size)
    return float(max(moments[-1, -1] - np.sum(along**2 / values[kept]), 0.0))


def t95(freedom: int) -> float:
    """The 97.5 % point of Student's t (Abramowitz and Stegun 26.7.5)."""
    z, n = Z95, float(max(freedom, 1))
    return float(
        z
        + (z**3 + z) / (4.0 * n)
        + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * n**2)
        + (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / (384.0 * n**3)
    )
