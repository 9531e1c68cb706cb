"""A streaming stage needs no more memory for a longer log."""

from __future__ import annotations

from pathlib import Path

import pytest
from memory import peak, stages


@pytest.mark.parametrize("name", ["resample", "filter", "differentiate", "identify", "validate"])
def test_memory_does_not_grow_with_the_log(name: str, tmp_path: Path) -> None:
    words = stages(tmp_path)[name]
    short, _ = peak(words, 100_000)
    long, _ = peak(words, 1_000_000)
    assert long < 1.1 * short
