"""The man pages: complete, without a finding of mandoc, and installed by a wheel."""

from __future__ import annotations

import re
import shutil
import subprocess
from datetime import date
from pathlib import Path

import click
import pytest
from conftest import ROOT

from scarid_cli.cli import COMMANDS, scarid
from scarid_cli.cli.manual import common, roff
from scarid_cli.cli.manual.__main__ import write
from scarid_cli.cli.manual.pages import Page, pages

PAGES = pages()
NAMES = [page.name for page in PAGES]


def shown(page: Page, folder: Path) -> str:
    """A page as a person reads it, on lines that are never broken within a word."""
    file = folder / f"{page.name}.1"
    file.write_text(roff.rendered(page, date(2026, 1, 1)), "utf-8")
    done = subprocess.run(
        ["mandoc", "-T", "utf8", "-O", "width=200", file], capture_output=True, check=True
    )
    return re.sub(".\b", "", done.stdout.decode())


needs_mandoc = pytest.mark.skipif(shutil.which("mandoc") is None, reason="mandoc is not installed")


def test_every_command_has_a_page() -> None:
    assert {f"scarid-{name}" for name in COMMANDS} <= set(NAMES)
    assert {"scarid", "scarid-robot-check"} <= set(NAMES)


@needs_mandoc
@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_mandoc_finds_nothing(page: Page, tmp_path: Path) -> None:
    file = tmp_path / f"{page.name}.1"
    file.write_text(roff.rendered(page, date(2026, 1, 1)), "utf-8")
    lint = ["mandoc", "-T", "lint", "-W", "warning", file]
    done = subprocess.run(lint, capture_output=True, text=True, check=False)
    assert (done.stdout, done.returncode) == ("", 0)


@needs_mandoc
@pytest.mark.parametrize("name", COMMANDS)
def test_a_page_shows_all_that_the_help_says(name: str, tmp_path: Path) -> None:
    """Every option, every word of their texts, and every example as it is typed."""
    command = scarid.get_command(click.Context(scarid), name)
    assert command
    text = shown(PAGES[NAMES.index(f"scarid-{name}")], tmp_path)
    flat = " ".join(text.split())
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            assert all(option in flat for option in parameter.opts), parameter.name
            assert " ".join((parameter.help or "").split()).replace("`", "") in flat
    for line in (command.help or "").splitlines():
        if line.strip().startswith("scarid "):
            assert f"    {line.strip()}\n" in text
    for title in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "ENVIRONMENT"):
        assert f"\n{title}\n" in text


def test_the_exit_statuses_are_those_of_the_documentation() -> None:
    documented = re.findall(r"^\| (\d+) \|", (ROOT / "docs/pipes.md").read_text("utf-8"), re.M)
    assert [status for status, _ in common.every(common.STATUSES)] == documented


def test_every_variable_of_the_program_is_on_the_page() -> None:
    read = {
        name
        for path in (ROOT / "scarid_cli").rglob("*.py")
        for name in re.findall(r'environ\.get\("(SCARID_\w+)"', path.read_text("utf-8"))
    }
    assert read <= {name for name, _ in common.every(common.ENVIRONMENT)}


def test_pages_are_dated_by_the_epoch_of_the_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    first = write(tmp_path)[0].read_text("utf-8")
    assert first.splitlines()[0].startswith(".TH SCARID 1 1970-01-02")
