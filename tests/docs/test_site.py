"""The site has every page and every command, and shows pages as GitHub does (`make site`)."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from conftest import ROOT
from markdown_it import MarkdownIt
from navigation import INDEX, SECTIONS, lost, navigation, pages
from reference import escaped, reference
from relinking import first_part, outside, place, relinked, targets

from scarid_cli import errors
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS
from scarid_cli.cli import COMMANDS, scarid

# What a browser would fetch by itself; a link that a reader may follow is none.
FETCHED = re.compile(
    r"<(?:script|img|iframe|source)[^>]+(?:src|srcset)=\"?(?:https?:)?//[^\" >]+"
    r"|<link[^>]+href=\"?(?:https?:)?//[^\" >]+(?![^>]*rel=\"?canonical)"
    r"|url\(['\"]?(?:https?:)?//[^)]+|@import[^;]+//[^;]+"
)
SHAPES = ("li", "pre", "tr", "h2", "h3")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built without a warning."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--quiet", "--strict", "-d", str(folder)]
    quiet = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    done = subprocess.run(command, cwd=ROOT, env=quiet, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    return folder


def test_every_page_stands_in_the_navigation() -> None:
    missing = lost(pages(ROOT / "docs"))
    assert missing == [], f"website/navigation.py names no section for {', '.join(missing)}"


def test_no_page_stands_there_twice_and_no_name_is_left_of_a_page_that_is_gone() -> None:
    there = {*pages(ROOT / "docs"), *reference(), *outside(ROOT).values()}
    placed = Counter(page for found in navigation(sorted(there)).values() for page in found)
    assert {page: n for page, n in placed.items() if n > 1 or page not in there} == {}


def test_a_page_that_nobody_placed_is_named() -> None:
    assert lost([INDEX, "theory.md", "theory-of-friction.md", "howto/a.md", "stray.md"]) == [
        "stray.md"
    ]


@pytest.mark.parametrize("name", COMMANDS)
def test_the_page_of_a_command_has_its_options(name: str) -> None:
    command = scarid.get_command(None, name)  # type: ignore[arg-type]
    assert command
    page = reference()[f"reference/commands/{name}.md"]
    options = [option for parameter in command.params for option in parameter.opts]
    shown = " ".join(re.findall(r"^`(-.*)`$", page, flags=re.MULTILINE))
    assert [o for o in options if o.startswith("-") and o not in re.split(r"[ ,]+", shown)] == []


def test_the_page_of_methods_has_each() -> None:
    page = reference()["reference/methods.md"]
    for name in (*DIFFERENTIATORS.names, *ESTIMATORS.names):
        assert f"\n### {name}\n" in page


def test_the_page_of_statuses_has_those_of_the_program() -> None:
    page = reference()["reference/exit-statuses.md"]
    declared = {value for value in vars(errors).values() if isinstance(value, int)}
    assert declared <= {int(status) for status in re.findall(r"^\| (\d+) \|", page, re.MULTILINE)}


def test_help_is_shown_as_it_is() -> None:
    assert escaped("a * b\n  <c> `d --e` [f], --g") == r"a \* b \<c\> `d --e` \[f\], `--g`"


def test_links_lead_to_where_the_files_stand_on_the_site() -> None:
    text = "[a](docs/pipes.md#failures) [b](samples/) ![c](docs/x.svg) [d](https://e.f) `](docs/g)`"
    assert relinked(text, "README.md", str.upper) == (
        "[a](pipes.md#failures) [b](repository/samples) ![c](x.svg) [d](https://e.f) `](docs/g)`"
    )
    assert (
        relinked("[a](../../DESIGN.md)", "docs/howto/b.md", str.upper)
        == "[a](../repository/DESIGN.md)"
    )
    assert relinked("[docs/pipes.md](docs/pipes.md#b)", "README.md", str.upper) == (
        "[DOCS/PIPES.MD](pipes.md#b)"
    )
    assert targets("[a](../DESIGN.md) [b](#c)", "docs/pipes.md") == {"DESIGN.md"}


def test_the_start_page_is_the_first_part_of_the_readme() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    assert 0.3 * len(readme) < len(first_part(readme)) < 0.8 * len(readme)


def test_nothing_is_fetched_from_elsewhere(site: Path) -> None:
    files = [path for kind in ("html", "css") for path in site.rglob(f"*.{kind}")]
    assert len(files) > 50
    found = {match for path in files for match in FETCHED.findall(path.read_text("utf-8"))}
    assert found == set()
    assert FETCHED.search('<script src="https://cdn.example/x.js">')


def test_search_knows_pages_and_methods(site: Path) -> None:
    entries = json.loads((site / "search" / "search_index.json").read_text("utf-8"))["docs"]
    places = {entry["location"] for entry in entries}
    assert {"reference/methods.html#kalman-lag", "pipes.html#failures"} <= places
    assert (site / "search" / "search_index.js").is_file()  # for a site opened as files


def test_a_page_has_the_lists_tables_and_blocks_that_github_shows(site: Path) -> None:
    github = MarkdownIt("commonmark").enable("table")
    wrong = {}
    for name in ("README.md", *(f"docs/{page}" for page in pages(ROOT / "docs"))):
        text = (ROOT / name).read_text("utf-8")
        wanted = shapes(github.render(first_part(text) if name == "README.md" else text))
        html = (site / place(name)).with_suffix(".html").read_text("utf-8")
        article = re.search(r"<article.*?</article>", html, flags=re.DOTALL)
        if article is None or (found := shapes(article[0])) != wanted:
            wrong[name] = (wanted, found)
    assert wrong == {}


def shapes(html: str) -> dict[str, int]:
    return {tag: len(re.findall(rf"<{tag}[ >]", html)) for tag in SHAPES}


def test_sections_are_those_of_a_reader() -> None:
    assert list(SECTIONS)[:4] == ["Tutorials", "How-to", "Reference", "Explanation"]
