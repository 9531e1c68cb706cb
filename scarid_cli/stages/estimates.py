"""The estimates of a parameter table with their covariance, as `urdf` needs them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.table import Table
from scarid_cli.stages.validate import estimates

REMEDY = "write the table with `identify -o parameters.parquet`"


@dataclass(frozen=True)
class Estimates:
    """Identified parameters and what is known of their errors.

    `robot` is the robot as it was identified, with `values` (parameters) in its units; `errors`
    (parameters) are robust where known, nan where none are; `covariance` (parameters, parameters)
    has nan in the rows and columns of parameters without errors. `dropped` are the indices of
    those that `identify --essential` set to zero. `fixed` are the table's further rows, which the
    torques are not linear in: name, unit, value. `remark` says why the covariance is diagonal; it
    is empty where the table has a covariance.
    """

    robot: Robot
    values: Array
    errors: Array
    covariance: Array
    dropped: tuple[int, ...]
    fixed: tuple[tuple[str, str, float], ...]
    remark: str


def estimates_with_covariance(table: Table, robot: Robot) -> Estimates:
    """Read a parameter table of this robot.

    The covariance of the metadata is that of white residuals, s^2 (W'W)^-1. It is multiplied by the
    mean ratio of the robust variances to its own: residuals are autocorrelated, so all errors are
    greater, but the directions that the motion does not determine are the same. The robust
    covariance itself has a rank of fewer than its blocks, often fewer than the parameters.
    """
    batches = list(table.batches)
    robot, values = estimates(replace(table, batches=iter(batches)), robot)
    whole = pa.Table.from_batches(batches)
    errors = _errors(whole)
    covariance, remark = _covariance(table, errors)
    count = len(values)
    names, units = (whole.column(key).to_pylist() for key in ("parameter", "unit"))
    return Estimates(
        robot=robot,
        values=values,
        errors=errors[:count],
        covariance=_given_the_rest(covariance, count),
        dropped=_dropped(table, names[:count], values, errors[:count]),
        fixed=tuple(zip(names, units, whole.column("estimate").to_pylist(), strict=True))[count:],
        remark=remark,
    )


def _errors(whole: pa.Table) -> Array:
    """The robust errors, or else the standard errors; nan where a parameter has none."""
    for name in ("robust_error", "standard_error"):
        if name in whole.column_names:
            errors = whole.column(name).to_numpy().astype(np.float64)
            if np.isfinite(errors).any():
                return np.where(errors >= 0.0, errors, np.nan)
    return np.full(whole.num_rows, np.nan)


def _covariance(table: Table, errors: Array) -> tuple[Array, str]:
    """The covariance of all rows, and why it is diagonal if it is."""
    diagonal = _of_errors(errors)
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
    covariance = _matrix(table, stored, len(errors))
    known = np.flatnonzero(np.isfinite(np.diag(covariance)))
    if not _positive_definite(covariance[np.ix_(known, known)]):
        return diagonal, (
            f"{table.name}: the covariance of the estimates is singular, so their correlations are "
            "neglected and R2 may fall; identify the parameters from a log that excites every joint"
        )
    variances = np.diag(covariance)
    both = np.isfinite(errors) & np.isfinite(variances) & (errors > 0.0)
    ratio = np.mean(errors[both] ** 2 / variances[both]) if both.any() else 1.0
    return ratio * covariance, ""


def _of_errors(errors: Array) -> Array:
    """A diagonal covariance; of equal weights if there are no errors."""
    known = np.isfinite(errors)
    variances = errors**2 if known.any() else np.ones(len(errors))
    covariance = np.diag(variances)
    covariance[~np.isfinite(variances), :] = covariance[:, ~np.isfinite(variances)] = np.nan
    return covariance


def _matrix(table: Table, stored: object, count: int) -> Array:
    """The nested list of the metadata as a matrix, with nan for null."""
    try:
        matrix = np.array(stored, dtype=np.float64)
        shape = matrix.shape
    except (TypeError, ValueError):
        shape = ()
    if shape != (count, count):
        raise bad_data(
            table.name,
            "a covariance in its metadata that is not a square matrix of its rows",
            expected=f"{count} lists of {count} numbers",
            remedy="write the table again with `identify`",
        )
    matrix[~np.isfinite(matrix.diagonal()), :] = np.nan
    matrix[:, ~np.isfinite(matrix.diagonal())] = np.nan
    return 0.5 * (matrix + matrix.T)


def _positive_definite(covariance: Array) -> bool:
    """By the eigenvalues of the correlation matrix, so that units do not matter."""
    variances = np.diag(covariance)
    if not len(variances) or not np.all(variances > 0.0) or not np.isfinite(covariance).all():
        return False
    errors = np.sqrt(variances)
    values = np.linalg.eigvalsh(covariance / np.outer(errors, errors))
    return bool(values[0] > len(values) * np.finfo(float).eps * values[-1])


def _given_the_rest(covariance: Array, count: int) -> Array:
    """The covariance of the first parameters when the others keep their values."""
    if count == len(covariance):
        return covariance
    known = np.isfinite(np.diag(covariance))
    a = np.flatnonzero(known[:count])
    b = count + np.flatnonzero(known[count:])
    across = covariance[np.ix_(a, b)]
    given = np.full((count, count), np.nan)
    given[np.ix_(a, a)] = covariance[np.ix_(a, a)] - across @ np.linalg.solve(
        covariance[np.ix_(b, b)], across.T
    )
    return given


def _dropped(table: Table, names: list[str], values: Array, errors: Array) -> tuple[int, ...]:
    """By the metadata; in CSV, what is exactly zero and has no errors though others have."""
    if "dropped" in table.meta.extra:
        stated = set(table.meta.extra["dropped"])
        return tuple(i for i, name in enumerate(names) if name in stated)
    if not np.isfinite(errors).any():
        return ()
    return tuple(np.flatnonzero((values == 0.0) & ~np.isfinite(errors)).tolist())
