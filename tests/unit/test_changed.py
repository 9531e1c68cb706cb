"""A small part of `make bench-changed`, with the arms and seeds of its tuning."""

from __future__ import annotations

import changed
import pytest
from conftest import long

pytest.importorskip("pinocchio")


@pytest.mark.parametrize("seed", [100, pytest.param(101, marks=long)])
def test_what_changed_between_two_logs_is_called_by_its_name(seed: int) -> None:
    arms, _ = changed.TUNING
    found = dict(changed.verdicts(arms, seed))
    assert found.pop("nothing") == "nothing"
    assert found.pop("compare") == "nothing"
    assert set(found.values()) == {"so"}
