"""The documentation page on tables: complete, and linked within itself."""

from __future__ import annotations

import re

from conftest import ROOT

from scarid_cli.reporting import schemas


def test_every_kind_of_table_has_its_section() -> None:
    kinds = {path.stem for path in (ROOT / "schemas").glob("*.json")}
    assert set(re.findall(r"^Kind `(\w+)`", schemas.page(), re.MULTILINE)) == kinds


def test_every_link_of_the_overview_leads_to_a_section() -> None:
    page = schemas.page()
    anchors = {title.lower().replace(" ", "-") for title in re.findall(r"^## (.*)", page, re.M)}
    assert set(re.findall(r"\(#([^)]*)\)", page)) == anchors
