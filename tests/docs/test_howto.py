"""A page of docs/howto answers one question on one screen."""

from __future__ import annotations

import pytest
from conftest import ROOT
from docs.pages import PAGES, blocks, prose

HOWTO = [page for page in PAGES if page.startswith("docs/howto/")]


@pytest.mark.parametrize("page", HOWTO)
def test_a_page_is_one_question_and_one_screen(page: str) -> None:
    title, *_rest = (ROOT / page).read_text("utf-8").splitlines()
    assert title.startswith("# ")
    assert title.endswith("?")
    assert len(prose(ROOT / page).split()) <= 200
    shell = blocks(page)
    assert 1 <= len(shell) <= 2
    assert any(block.shown for block in shell)


def test_there_are_such_pages() -> None:
    assert len(HOWTO) >= 7
