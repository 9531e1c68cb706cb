"""What identify sees by itself in a measurement, of which it looks at blocks where it is long."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest

from scarid_cli.io.table import Metadata, Table
from scarid_cli.stages.records.compact import Compact
from scarid_cli.stages.remarks import glance

H, LENGTH = 0.01, 4000


def held(factor: float, glitch: int | None = None) -> Compact:
    """A log of one joint whose velocity column is the velocity times a factor."""
    t = H * np.arange(LENGTH)
    q, dq = np.sin(2.0 * t), 2.0 * np.cos(2.0 * t)
    if glitch is not None:
        q[glitch] += 0.5
    columns = {"t": t, "q1": q, "dq1": factor * dq, "tau1": 3.0 * np.sin(2.0 * t + 0.3)}
    table = pa.table(columns)
    meta = Metadata(kind="measurement", period=H)
    return Compact.of(Table("log", table.schema, meta, iter(table.to_batches())), 1)


@pytest.mark.parametrize("rows", [20, 150, LENGTH])  # of a block; the last: the log is not long
def test_blocks_of_a_long_log_show_what_all_of_it_does(
    rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(glance, "ROWS", rows)
    assert glance.of_measurement(held(1.0)) == []
    (found,) = glance.of_measurement(held(57.3))
    assert found.name == "velocities"
    assert "57.3" in found.text


def test_a_glitch_between_the_blocks_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Single rows are searched in all of the log."""
    monkeypatch.setattr(glance, "ROWS", 20)
    for row in (15, 777, 2222, LENGTH - 30):
        (found,) = [x for x in glance.of_measurement(held(1.0, row)) if x.name == "glitches"]
        assert f"{row + 1:,}" in found.text or str(row + 1) in found.text
