"""The estimates in a parameter table and their covariance, as `scarid urdf` needs them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import BadData, bad_data
from scarid_cli.io.table import Table
from scarid_cli.stages.results.parameters import Identified, identified

REMEDY = "write the table with `identify -o parameters.parquet`"


@dataclass(frozen=True)
class Estimates:
    """Identified parameters and their errors.

    `model` is the content of the table. `errors` (parameters) are robust standard errors where
    known, nan where there are none. `dropped` are the indices of the values that `identify
    --essential` set to zero. `full` are the estimates before that and `covariance` (parameters,
    parameters) is theirs, with nan in the rows and columns of parameters without errors. `fixed`
    has the name, unit and value of the table's further rows, in which the torques are not linear.
    `remark` explains why the covariance is diagonal; it is empty if it is not.
    """

    model: Identified
    errors: Array
    full: Array
    covariance: Array
    dropped: tuple[int, ...]
    fixed: tuple[tuple[str, str, float], ...]
    remark: str

    @property
    def robot(self) -> Robot:
        """The robot as it was identified."""
        return self.model.robot

    @property
    def values(self) -> Array:
        """The estimates (parameters), in the units of the robot."""
        return self.model.theta


def estimates_with_covariance(table: Table, robot: Robot) -> Estimates:
    """Read a parameter table of this robot, with the covariance in its metadata."""
    batches = list(table.batches)
    content = identified(replace(table, batches=iter(batches)), robot)
    values = content.theta
    whole = pa.Table.from_batches(batches)
    names, units = (whole.column(key).to_pylist() for key in ("parameter", "unit"))
    fixed = tuple(zip(names, units, whole.column("estimate").to_pylist(), strict=True))
    count, errors = len(values), errors_of(whole)
    covariance, remark = _covariance(table, errors)
    full = values if remark else _full_estimates(table, values, len(errors))
    return Estimates(
        model=content,
        errors=errors[:count],
        full=full,
        covariance=_conditional(covariance, count),
        dropped=_dropped(table, names[:count], values, errors[:count]),
        fixed=fixed[count:],
        remark=remark,
    )


def errors_of(whole: pa.Table) -> Array:
    """The robust standard errors, or else the classical ones; nan where a parameter has none."""
    for name in ("robust_error", "standard_error"):
        if name in whole.column_names:
            errors = whole.column(name).to_numpy().astype(np.float64)
            if np.isfinite(errors).any():
                return np.where(errors >= 0.0, errors, np.nan)
    return np.full(whole.num_rows, np.nan)


def _covariance(table: Table, errors: Array) -> tuple[Array, str]:
    """The covariance of all rows, and the remark if it is diagonal."""
    diagonal = _diagonal(errors)
    if not np.isfinite(errors).any():
        return (
            diagonal,
            f"{table.name}: no errors, so every parameter has the same weight; {REMEDY}",
        )
    stored = table.meta.extra.get("covariance")
    if stored is None:
        return diagonal, (
            f"{table.name}: no covariance of the estimates (CSV cannot hold it), so their "
            f"correlations are neglected and R2 may fall; {REMEDY}"
        )
    covariance = array_of(table, "covariance", stored, (len(errors), len(errors)))
    covariance = 0.5 * (covariance + covariance.T)
    unknown = ~np.isfinite(np.diag(covariance))
    covariance[unknown, :] = covariance[:, unknown] = np.nan
    if not _positive(covariance[np.ix_(~unknown, ~unknown)]):
        return diagonal, (
            f"{table.name}: its covariance has negative variances, so the correlations of the "
            f"estimates are neglected and R2 may fall; {REMEDY}"
        )
    return covariance, ""


def _full_estimates(table: Table, values: Array, rows: int) -> Array:
    """The estimates before parameters were dropped, if any were."""
    stored = table.meta.extra.get("full_estimates")
    if stored is None:
        return values
    return array_of(table, "full_estimates", stored, (rows,))[: len(values)]


def _diagonal(errors: Array) -> Array:
    """The covariance of uncorrelated estimates; all variances are 1 if there are no errors."""
    known = np.isfinite(errors)
    variances = errors**2 if known.any() else np.ones(len(errors))
    covariance = np.diag(variances)
    unknown = ~np.isfinite(variances)
    covariance[unknown, :] = covariance[:, unknown] = np.nan
    return covariance


def array_of(table: Table, key: str, stored: object, shape: tuple[int, ...]) -> Array:
    """Nested lists in the metadata as an array; null becomes nan."""
    try:
        array = np.array(stored, dtype=np.float64)
    except (TypeError, ValueError):
        raise _misshapen(table, key, shape) from None
    if array.shape != shape:
        raise _misshapen(table, key, shape)
    return array


def _misshapen(table: Table, key: str, shape: tuple[int, ...]) -> BadData:
    return bad_data(
        table.name,
        f"metadata `{key}` of another size",
        expected=f"{' by '.join(map(str, shape))} numbers, one for each row",
        remedy="write the table again with `scarid identify`",
    )


def _positive(covariance: Array) -> bool:
    """Whether no combination of parameters has a negative variance, up to rounding errors.

    The eigenvalues are those of the correlation matrix, so the result does not depend on units.
    """
    variances = np.diag(covariance)
    if not len(variances) or not np.all(variances > 0.0) or not np.isfinite(covariance).all():
        return False
    errors = np.sqrt(variances)
    values = np.linalg.eigvalsh(covariance / np.outer(errors, errors))
    return bool(values[0] > -len(values) * np.finfo(float).eps * values[-1])


def _conditional(covariance: Array, count: int) -> Array:
    """The covariance of the first parameters, given the values of the others."""
    known = np.isfinite(np.diag(covariance))
    a, b = np.flatnonzero(known[:count]), count + np.flatnonzero(known[count:])
    across = covariance[np.ix_(a, b)]
    given = np.full((count, count), np.nan)
    explained = across @ np.linalg.solve(covariance[np.ix_(b, b)], across.T)
    given[np.ix_(a, a)] = covariance[np.ix_(a, a)] - explained
    return given


def _dropped(table: Table, names: list[str], values: Array, errors: Array) -> tuple[int, ...]:
    """The indices of dropped parameters, from the metadata.

    A CSV has no metadata: there, parameters count as dropped that are exactly zero and have no
    error although others have one.
    """
    if "dropped" in table.meta.extra:
        stated = set(table.meta.extra["dropped"])
        return tuple(i for i, name in enumerate(names) if name in stated)
    if not np.isfinite(errors).any():
        return ()
    return tuple(np.flatnonzero((values == 0.0) & ~np.isfinite(errors)).tolist())
