"""The memory that may be used."""

from __future__ import annotations

import pytest

from scarid_cli import memory
from scarid_cli.errors import UsageFault


@pytest.mark.parametrize(
    ("text", "bytes_"), [("500M", 500 * 2**20), ("0.5g", 2**29), ("1048576", 2**20), ("2KiB", 2048)]
)
def test_it_is_stated_in_bytes(monkeypatch: pytest.MonkeyPatch, text: str, bytes_: int) -> None:
    monkeypatch.setenv(memory.VARIABLE, text)
    assert memory.limit() == bytes_


@pytest.mark.parametrize("text", ["much", "-1G", "infM", "G"])
def test_what_is_no_number_of_bytes_is_refused(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setenv(memory.VARIABLE, text)
    with pytest.raises(UsageFault, match=f"SCARID_MEMORY={text}: expected bytes"):
        memory.limit()


def test_else_it_is_that_of_the_machine_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(memory.VARIABLE, raising=False)
    assert 2**26 < memory.limit() < 2**50
