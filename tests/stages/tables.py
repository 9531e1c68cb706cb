"""Small tables for the tests of the stages, cut into batches of any size."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.excitations.quintic import Excitation
from scarid_cli.algorithms.robots import reading
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.io.table import Metadata, Table, doubles, number

PERIOD = 0.005


def table(columns: dict[str, np.ndarray], sizes: Sequence[int] = ()) -> Table:
    """A checked table in batches of these sizes, over and over; () is all rows at once."""
    schema = pa.schema([number(name) for name in columns])
    batch = pa.RecordBatch.from_arrays([doubles(x) for x in columns.values()], schema=schema)
    meta = Metadata(kind="motion", period=PERIOD)
    return Table("test", schema, meta, cut(batch, sizes))


def cut(batch: pa.RecordBatch, sizes: Sequence[int]) -> Iterator[pa.RecordBatch]:
    start = turn = 0
    while start < batch.num_rows:
        size = sizes[turn % len(sizes)] if sizes else batch.num_rows
        yield batch.slice(start, size)
        start += size
        turn += 1


def collected(result: Table) -> pa.Table:
    """All rows of a table."""
    return pa.Table.from_batches(list(result.batches), result.schema).combine_chunks()


class Kept:
    """A sink that keeps what it is sent."""

    def __init__(self) -> None:
        self.batches: list[pa.RecordBatch] = []

    def start(self, schema: pa.Schema) -> None:
        self.schema = schema

    def write(self, batch: pa.RecordBatch) -> None:
        self.batches.append(batch)

    @property
    def table(self) -> pa.Table:
        schema = self.schema.remove_metadata()
        return pa.Table.from_batches(self.batches, schema).combine_chunks()


SCARA = reading.load("scara2")


def motion(rows: int = 400, seed: int = 0) -> dict[str, np.ndarray]:
    """A noisy motion of two joints with velocities, accelerations, torques and references."""
    rng = np.random.default_rng(seed)
    t = np.arange(rows) * PERIOD
    columns = {"t": t}
    exact = []
    for i, rate in ((1, 3.0), (2, 5.0)):
        noise = rng.standard_normal((3, rows))
        exact.append((np.sin(rate * t), rate * np.cos(rate * t), -(rate**2) * np.sin(rate * t)))
        q, dq, ddq = exact[-1]
        columns[f"q{i}"] = np.round(q / 1e-4 + noise[0]) * 1e-4
        columns[f"dq{i}"] = dq + 0.01 * noise[1]
        columns[f"ddq{i}"] = ddq + 0.1 * noise[2]
        columns |= {f"q{i}_ref": q, f"dq{i}_ref": dq, f"ddq{i}_ref": ddq}
    W = SCARA.regressor(*(np.array(signal) for signal in zip(*exact, strict=True)))
    for i, tau in enumerate(SCARA.torques(W, SCARA.apriori), start=1):
        columns[f"tau{i}"] = tau + 0.1 * rng.standard_normal(rows)
    return columns


def references() -> dict[str, np.ndarray]:
    """Two seconds of a reference within generous limits."""
    limits = Limits(-np.ones(2), np.ones(2), np.full(2, 3.0), np.full(2, 20.0))
    path = Excitation(0.5, 1.0).trajectory(limits, limits.home, 2.0, np.random.default_rng(1))
    t = np.arange(401) * PERIOD
    rows = [row for signal in path.sample(t) for row in signal]
    names = [f"{signal}{i}_ref" for signal in ("q", "dq", "ddq") for i in (1, 2)]
    return {"t": t, **dict(zip(names, rows, strict=True))}
