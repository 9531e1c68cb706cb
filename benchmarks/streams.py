"""Write a log of any length to standard output, as an Arrow stream: `python streams.py KIND ROWS`.

KIND is `motion` (two joints at 200 Hz, with derivatives) or `six-axes` (six joints at 1 kHz).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence

import numpy as np
import pyarrow as pa

from scarid_cli.arrays import Array

BATCH = 8192  # rows
AXES = 6


def motion(t: Array) -> dict[str, Array]:
    """Two joints: positions, torques, velocities and accelerations."""
    q, dq = [np.sin(t), np.sin(1.3 * t)], [np.cos(t), 1.3 * np.cos(1.3 * t)]
    ddq = [-np.sin(t) - 0.5 * np.sin(3 * t), -1.69 * np.sin(1.3 * t)]
    signals = {"q": q, "tau": [3.0 * q[0], q[1]], "dq": dq, "ddq": ddq}
    return {"t": t, **columns_of(signals)}


def six_axes(t: Array) -> dict[str, Array]:
    """Six joints: positions and torques."""
    q = [np.sin((1.0 + 0.17 * i) * t) + 0.3 * np.cos(0.41 * i * t) for i in range(AXES)]
    return {"t": t, **columns_of({"q": q, "tau": [np.cos(x) + x for x in q]})}


def columns_of(signals: Mapping[str, Sequence[Array]]) -> dict[str, Array]:
    """A column for each joint of each signal."""
    return {
        f"{signal}{i}": x for signal, joints in signals.items() for i, x in enumerate(joints, 1)
    }


KINDS: dict[str, tuple[Callable[[Array], dict[str, Array]], float]] = {
    "motion": (motion, 200.0),
    "six-axes": (six_axes, 1000.0),
}


def main(kind: str, rows: int) -> None:
    columns, rate = KINDS[kind]
    schema = pa.schema([(name, pa.float64()) for name in columns(np.zeros(1))])
    with pa.ipc.new_stream(sys.stdout.buffer, schema) as writer:
        for start in range(0, rows, BATCH):
            t = np.arange(start, min(start + BATCH, rows)) / rate
            arrays = [pa.array(x) for x in columns(t).values()]
            writer.write_batch(pa.RecordBatch.from_arrays(arrays, schema=schema))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
