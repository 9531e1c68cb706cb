"""Logs whose torques are divided by the gains of their joints."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.regression.treatment import GainErrors
from scarid_cli.arrays import Array
from scarid_cli.errors import bad_data
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix, with_columns

TORQUE_GAINS = "torque_gains"  # key of the metadata of logs and of parameters


@dataclass(frozen=True)
class Correction:
    """The gains (joints) by which torques are divided; `covariance` is that of their logarithms."""

    gains: Array
    covariance: Array

    @property
    def errors(self) -> GainErrors:
        """How far the gains are wrong together, relative to them, in several directions."""
        values, vectors = np.linalg.eigh(self.covariance)
        rows = np.sqrt(np.maximum(values, 0.0))[:, None] * vectors.T
        return tuple(map(tuple, rows.tolist()))


def correction(table: Table, joints: int, otherwise: float = 0.0) -> Correction:
    """The correction that a table of gains states.

    Torques of a joint whose gain is not told stay as they are, with the relative error `otherwise`.
    """
    whole = pa.Table.from_batches(list(table.batches), table.schema)
    rows = {int(row["joint"]): row for row in whole.to_pylist()}
    if sorted(rows) != list(range(1, joints + 1)):
        raise bad_data(
            table.name,
            f"the joints {', '.join(map(str, sorted(rows)))}",
            expected=f"one row for each of {joints} joints",
            remedy="give the table that `scarid gains` wrote for this robot",
            column="joint",
        )
    k = np.array([rows[j]["gain"] or np.nan for j in sorted(rows)], dtype=np.float64)
    if np.any(k <= 0.0):
        raise bad_data(
            table.name,
            "a gain that is not positive",
            expected="the logged torque over the true one",
            remedy="give the table that `scarid gains` wrote",
            column="gain",
        )
    told = np.isfinite(k)
    errors = np.array([rows[j]["robust_error"] or 0.0 for j in sorted(rows)]) / np.where(told, k, 1)
    stored = np.array(table.meta.extra.get("covariance") or np.diag(errors**2), dtype=np.float64)
    if stored.shape != (joints, joints):
        stored = np.diag(errors**2)
    covariance = np.where(np.outer(told, told), stored, 0.0)
    covariance += np.diag(np.where(told, 0.0, otherwise**2))
    return Correction(np.where(told, k, 1.0), covariance)


def corrected(table: Table, gains: Sequence[float]) -> Table:
    """The log with each torque divided by the gain of its joint; the metadata state the gains."""
    columns = of_joints(len(gains), "tau{i}")
    extra = {**table.meta.extra, TORQUE_GAINS: [float(k) for k in gains]}
    batches = _divided(table, columns, np.array(gains)[:, None])
    return replace(table, meta=replace(table.meta, extra=extra), batches=batches)


def _divided(table: Table, columns: list[str], k: Array) -> Iterator[pa.RecordBatch]:
    for batch in table.batches:
        new = dict(zip(columns, matrix(batch, columns) / k, strict=True))
        yield with_columns(batch, table.schema, new)


def gains_of(table: Table) -> list[float]:
    """The gains by which the torques of a log or an identification were divided; none if empty."""
    return list(table.meta.extra.get(TORQUE_GAINS) or [])


def told_gains(gains: Sequence[float]) -> str:
    """`joint 2 by 1.3, joint 4 by 0.799`: those that change anything."""
    return ", ".join(
        f"joint {j} by {k:.4g}" for j, k in enumerate(gains, start=1) if abs(k - 1.0) > 1e-6
    )
