"""Whether what a saved state contains is a state: types by annotation, and sizes that go together.

A checksum tells that a file is as it was written, not who wrote it.
"""

from __future__ import annotations

import types
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from typing import Any, Union, get_args, get_origin, get_type_hints

import numpy as np

from scarid_cli.algorithms.estimators.adaptive import FILTERS, LONGEST, Bank
from scarid_cli.algorithms.estimators.ekf import FilterState
from scarid_cli.algorithms.estimators.rls import WeightedInformation
from scarid_cli.algorithms.regression.counting import Speeds
from scarid_cli.algorithms.regression.information import RUNNING, Information
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.algorithms.uncertainty.subsample import Subsample

LARGEST = 1e100  # of a number; its square does not overflow
MOST = 1 << 53  # of a count


def require_state(checkpoint: Any, state: Any, joints: int, parameters: int) -> None:
    """Refuse (ValueError) what is no checkpoint of an estimator with this type of state."""
    _require(checkpoint, Checkpoint)
    _require(checkpoint.state, state)
    _require_sizes(checkpoint, joints, parameters)


def _require(value: Any, kind: Any) -> None:
    """Refuse a value that is not of an annotated type."""
    origin, inner = get_origin(kind), get_args(kind)
    if origin in (Union, types.UnionType):
        known = type(None) if value is None else next(x for x in inner if x is not type(None))
        _require(value, known)
    elif origin in (tuple, list):
        _hold(isinstance(value, tuple | list))
        for item in value:
            _require(item, inner[0])
    elif origin is np.ndarray:
        _hold(isinstance(value, np.ndarray) and value.dtype == get_args(inner[1])[0])
    elif is_dataclass(kind):
        _hold(type(value) is kind)
        hints = get_type_hints(kind)
        for field in fields(kind):
            _require(getattr(value, field.name), hints[field.name])
    elif kind is not Any:
        _hold(type(value) is kind or (kind is float and type(value) is int))
        if not isinstance(value, str | None):
            _hold(abs(value) < (LARGEST if kind is float else MOST))


def _require_sizes(value: Any, joints: int, parameters: int) -> None:
    """Refuse arrays and counts that do not belong together, in all parts of a checkpoint."""
    if check := SIZES.get(type(value)):
        check(value, joints, parameters)
    if isinstance(value, np.ndarray) and value.dtype == np.float64:
        _hold(bool((np.abs(value) < LARGEST).all()))
    inner = tuple(value) if isinstance(value, tuple | list) else ()
    if is_dataclass(value):
        inner = tuple(getattr(value, field.name) for field in fields(value))
    if not isinstance(value, FilterState):  # whose velocities are nan before the first sample
        for part in inner:
            _require_sizes(part, joints, parameters)


def _rows(rows: Rows, joints: int, parameters: int) -> None:
    n = len(rows.at)
    _hold(rows.W.shape == (n, joints, parameters) and rows.y.shape == (n, joints))
    _hold(rows.scales.shape == (n, joints) and rows.motion.shape == (4, joints, n))
    _hold(rows.reference is None or rows.reference.shape == (2, joints, n))
    _hold(rows.at.ndim == 1 and n > 0 and rows.at[0] >= 0 and bool((np.diff(rows.at) > 0).all()))
    _hold(rows.h > 0.0 and int(rows.at[-1]) < MOST)
    _hold(rows.bandwidth is None or rows.bandwidth > 0.0)
    _hold(rows.order is None or rows.order > 0)
    _hold(len(rows.noise) in (0, joints) and all(0.0 <= x < LARGEST for x in rows.noise))


def _blocks(blocks: Blocks, joints: int, parameters: int) -> None:
    size = (joints, parameters + 2, parameters + 2)
    _hold(blocks.length > 0 and len(blocks.numbers) == len(blocks.products))
    _hold(all(product.shape == size for product in blocks.products))
    _hold(list(blocks.numbers) == sorted({x for x in blocks.numbers if x >= 0}))


def _subsample(kept: Subsample, _joints: int, _parameters: int) -> None:
    counts = (kept.samples, kept.numbers, kept.thinnest, kept.thin, kept.stride)
    _hold(min(counts) >= 1 and min(kept.total, kept.counted) >= 0)


def _information(found: Information, _joints: int, parameters: int) -> None:
    _hold(found.weighted.shape == (parameters, parameters + 1))
    _hold(bool((np.diag(found.weighted) >= 0.0).all()))
    _hold(min(found.residual, found.weight, found.count) >= 0.0)


def _weighted(found: WeightedInformation, joints: int, _parameters: int) -> None:
    _hold(found.residuals.shape in ((0, RUNNING), (joints, RUNNING)))


def _bank(found: Bank, joints: int, parameters: int) -> None:
    filters, p = len(found.weights), parameters
    _hold(filters == FILTERS and found.means.shape == (filters, p))
    _hold(found.covariances.shape == (filters, p, p) and found.gram.shape == (p, p))
    _hold(found.noise.shape in ((0,), (joints,)))
    _hold(found.noise.shape == found.torque.shape == found.alike.shape)
    _hold(min(found.seen, found.rows, found.windows) >= 0 and bool((found.weights >= 0.0).all()))
    positive = all(bool((x > 0.0).all()) for x in (found.noise, found.alike))
    _hold(positive and len(found.window) < LONGEST and abs(found.weights.sum() - 1.0) < 1e-6)


def _filter(found: FilterState, joints: int, parameters: int) -> None:
    size = 2 * joints + parameters
    _hold(found.x.shape == (size,) and found.covariance.shape == (size, size))
    _hold(bool((np.abs(found.x[2 * joints :]) < LARGEST).all()))
    _hold(bool((np.abs(found.covariance) < LARGEST).all()))


def _speeds(found: Speeds, joints: int, _parameters: int) -> None:
    _hold(found.sums.shape == (joints,) and bool((found.sums >= 0.0).all()) and found.samples >= 0)


SIZES: dict[type, Callable[[Any, int, int], None]] = {
    Rows: _rows,
    Blocks: _blocks,
    Subsample: _subsample,
    Information: _information,
    WeightedInformation: _weighted,
    FilterState: _filter,
    Bank: _bank,
    Speeds: _speeds,
}


def _hold(condition: object) -> None:
    if not condition:
        raise ValueError("another structure")
