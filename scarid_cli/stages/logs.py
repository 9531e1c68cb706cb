"""A table as a log in memory, as the checks take it."""

from __future__ import annotations

import numpy as np

from scarid_cli.algorithms.checks.log import Log
from scarid_cli.io.schemas import of_joints
from scarid_cli.io.table import Table, matrix


def log_of(table: Table, joints: int) -> Log:
    """The log of a table, with nan for what is missing."""
    names = ["t", *of_joints(joints, "q{i}", "tau{i}")]
    parts = [matrix(batch, names) for batch in table.batches]
    whole = np.concatenate(parts, axis=1) if parts else np.empty((len(names), 0))
    whole = np.where(np.isfinite(whole), whole, np.nan)
    return Log(whole[0], whole[1 : joints + 1], whole[joints + 1 :])
