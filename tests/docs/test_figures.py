"""The figures of the documentation show what the commands give, and what their pages say."""

from __future__ import annotations

import importlib
import re
from types import ModuleType
from typing import Any
from xml.etree import ElementTree as ET

import click
import pytest
from conftest import ROOT
from figures.__main__ import NAMES
from figures.common import FIGURES, digest, kept

from scarid_cli.cli import scarid

SLOW = ("drift", "matching", "payload")  # left to `make figures`
LARGEST = 150_000  # bytes of a picture
ROUNDING = 2e-3  # of a number with five digits, on another machine


def module(name: str) -> ModuleType:
    return importlib.import_module(f"figures.{name}")


def assert_part(found: Any, of: Any, where: str) -> None:
    """Each number of `found` is in `of`, which may have more: keys, or items at the end."""
    if isinstance(found, dict):
        for key, value in found.items():
            assert_part(value, of[key], f"{where} {key}")
    elif isinstance(found, list) and found and isinstance(found[0], float):
        scale = max(map(abs, of))
        assert found == pytest.approx(of[: len(found)], ROUNDING, ROUNDING * scale), where
    elif isinstance(found, list):
        for i, (one, other) in enumerate(zip(found, of, strict=False)):
            assert_part(one, other, f"{where}[{i}]")
    else:
        assert found == (pytest.approx(of) if isinstance(found, float) else of), where


@pytest.mark.parametrize("name", [name for name in NAMES if name not in SLOW])
def test_the_kept_data_are_what_the_commands_give(name: str) -> None:
    """Some of the data, where all take long; the others are left to `make figures`."""
    figure = module(name)
    assert_part(getattr(figure, "part", figure.data)(), kept(name), name)


@pytest.mark.parametrize("name", NAMES)
def test_a_picture_shows_the_kept_data(name: str) -> None:
    text = (FIGURES / f"{name}.svg").read_text("utf-8")
    assert f"<!-- data {digest(kept(name))} -->" in text
    assert len(text.encode()) < LARGEST
    assert "prefers-color-scheme:dark" in text
    ET.fromstring(text)


@pytest.mark.parametrize("name", NAMES)
def test_the_kept_data_can_be_drawn(name: str) -> None:
    assert module(name).drawn(kept(name)).axes


@pytest.mark.parametrize("name", NAMES)
def test_the_quoted_commands_have_these_options(name: str) -> None:
    lines = (module(name).__doc__ or "").split("\n")
    commands = [stage for line in lines if line.startswith("scarid ")
                for stage in re.split(r" then scarid | then | \| scarid ", line[7:])]  # fmt: skip
    assert commands or "make gauntlet" in lines
    for stage in commands:
        word, _, rest = stage.partition(" ")
        command = scarid.get_command(click.Context(scarid), word)
        assert command, word
        known = {option for parameter in command.params for option in parameter.opts}
        known |= {option for parameter in command.params for option in parameter.secondary_opts}
        assert set(re.findall(r"(?<!\S)--?[a-z][a-z-]*", rest)) <= known, word


@pytest.mark.parametrize("name", NAMES)
def test_a_page_shows_the_figure(name: str) -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    assert any(f"figures/{name}.svg" in page.read_text("utf-8") for page in pages)
