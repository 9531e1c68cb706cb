"""The rate at which a table is to be resampled."""

from __future__ import annotations

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.processes.holding import held_in
from scarid_cli.algorithms.processes.rates import resampling_rate
from scarid_cli.io.table import matrix
from scarid_cli.stages.records.holding import measured


def advised_rate(rows: pa.RecordBatch) -> str:
    """The rate [Hz] at which a log is to be resampled, as it is typed, given its first rows.

    It is that of the sensors, if they are slower than the rows; HZ if time never increases.
    """
    t, *values = matrix(rows, ["t", *measured(rows.schema)])
    known = np.isfinite(t)
    x = np.array(values).reshape(len(values), len(t))[:, known]
    held, _ = held_in(t[known], x)
    return resampling_rate(t[known], held) or "HZ"
