"""A table as a log in memory, as the checks take it."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.checks.log import Log
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import SEGMENT, Table, matrix
from scarid_cli.stages.records.holding import measured


def log_of(table: Table, joints: int) -> Log:
    """The log of a table, with nan for what is missing."""
    names = ["t", *of_joints(joints, "q{i}", "tau{i}")]
    others = [name for name in measured(table.schema) if name not in names]
    names += others
    velocities = velocities_of(table, joints)
    names += [*velocities, *([SEGMENT] if SEGMENT in table.columns else [])]
    parts = [matrix(batch, names) for batch in table.batches]
    whole = np.concatenate(parts, axis=1) if parts else np.empty((len(names), 0))
    whole = np.where(np.isfinite(whole), whole, np.nan)
    ends = np.cumsum([1, joints, joints, len(others), len(velocities)])
    t, q, tau, rest, dq, segment = np.split(whole, ends)
    return Log(
        t[0],
        q,
        tau,
        rest if others else None,
        dq if velocities else None,
        segment[0] if len(segment) else None,
    )


def velocities_of(table: Table, joints: int) -> list[str]:
    """The columns of measured velocities, if every joint has one; none of a motion."""
    if set(of_joints(joints, "ddq{i}")) <= set(table.columns):
        return []
    for name in ("dq{i}_measured", "dq{i}"):
        columns = of_joints(joints, name)
        if set(columns) <= set(table.columns):
            return columns
    return []
