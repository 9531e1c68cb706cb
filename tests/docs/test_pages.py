"""The documentation names what there is, and its references lead somewhere."""

from __future__ import annotations

import itertools
import re
import subprocess
from pathlib import Path

import pytest
from conftest import ROOT
from docs.pages import PAGES, prose

from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS, ESTIMATORS, EXCITATIONS
from scarid_cli.algorithms.imperfections.registry import IMPERFECTIONS
from scarid_cli.algorithms.robots.reading import built_in
from scarid_cli.cli import COMMANDS

NAMES = {
    "command": list(COMMANDS),
    "differentiator": DIFFERENTIATORS.names,
    "estimator": ESTIMATORS.names,
    "excitation": EXCITATIONS.names,
    "imperfection": list(IMPERFECTIONS),
    "robot": built_in(),
}
# Theory and decisions are read like the others, though their shell blocks are not run.
EVERY = sorted({*PAGES, *(str(p.relative_to(ROOT)) for p in (ROOT / "docs").glob("*/*.md"))})
# Nobody reads a reference, or what was measured when, from top to bottom.
REFERENCES = ("docs/tables.md", "docs/gauntlet/tables.md", "docs/design/research-log.md")
TEN_MINUTES = 2500  # words
USERS = [page for page in PAGES if page not in ("CONTRIBUTING.md", "DESIGN.md")]
# What only those who wrote the program have read.
FOREIGN = re.compile(
    r"of the equations|equations\.md|[Cc]ommand contract|\bdesign\.md|[Ee]quations? [A-F]\.\d"
    r"|[Ss]ection [A-F]\.\d|(?<!design )\b[A-F]\.\d{1,2}\b"
)


def tracked() -> list[Path]:
    """Every text file of the repository."""
    names = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    kinds = {".md", ".py", ".pxd", ".toml", ".json", ".html", ""}
    return [ROOT / n for n in names if Path(n).suffix in kinds and (ROOT / n).is_file()]


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, names in NAMES.items() for name in names]
)
def test_the_documentation_names_every_choice(kind: str, name: str) -> None:
    pages = [page for page in USERS if re.search(rf"`{name}[` ]", (ROOT / page).read_text("utf-8"))]
    assert pages, f"no page names the {kind} `{name}`"


def test_the_page_on_the_simulator_has_a_row_for_every_imperfection_with_its_unit() -> None:
    page = (ROOT / "docs" / "simulator.md").read_text("utf-8").split("\n## Imperfections\n")[1]
    rows = re.findall(r"^\| `([a-z-]+)` \| ([^|]*?) ?\|", page, flags=re.MULTILINE)
    assert sorted(rows) == sorted((name, kind.unit()) for name, kind in IMPERFECTIONS.items())


def test_pages_that_anything_names_are_there() -> None:
    named = {
        (str(path.relative_to(ROOT)), name)
        for path in tracked()
        for name in re.findall(r"(?<![\w/])docs/[\w-]+\.md", path.read_text("utf-8"))
    }
    assert {(path, name) for path, name in named if not (ROOT / name).is_file()} == set()


@pytest.mark.parametrize("name", EVERY)
def test_links_lead_somewhere(name: str) -> None:
    page = ROOT / name
    missing = []
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        path, _, anchor = target.partition("#")
        if "://" in target:
            continue
        there = (page.parent / path) if path else page
        if not there.exists() or (anchor and anchor not in anchors(there)):
            missing.append(target)
    assert missing == []


@pytest.mark.parametrize("name", [name for name in EVERY if name not in REFERENCES])
def test_a_page_is_read_in_ten_minutes(name: str) -> None:
    assert len((ROOT / name).read_text("utf-8").split()) <= TEN_MINUTES


def test_nothing_is_a_link_to_somewhere_else() -> None:
    names = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert [name for name in names if (ROOT / name).is_symlink()] == []


@pytest.mark.parametrize("name", PAGES)
def test_no_line_is_followed_by_its_own_other_version(name: str) -> None:
    lines = [line for line in prose(ROOT / name).splitlines() if not line.lstrip().startswith("|")]
    twice = [line for line, after in itertools.pairwise(lines) if line[:30] == after[:30]]
    assert [line for line in twice if len(line) > 40] == []


def anchors(page: Path) -> set[str]:
    """The names that GitHub gives to the headings of a page."""
    headings = re.findall(r"^#+ (.*)$", prose(page), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_every_page_is_reached_from_the_readme() -> None:
    readme = (ROOT / "README.md").read_text("utf-8")
    pages = [*(f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")), "CONTRIBUTING.md"]
    assert [page for page in pages if f"({page})" not in readme] == []


def test_the_readme_is_a_front_page() -> None:
    assert len((ROOT / "README.md").read_text("utf-8").splitlines()) <= 150


def test_nothing_refers_to_documents_that_are_not_here() -> None:
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in tracked()
        if path != Path(__file__)
        for number, line in enumerate(path.read_text("utf-8").splitlines(), start=1)
        if FOREIGN.search(line)
    ]
    assert found == []
