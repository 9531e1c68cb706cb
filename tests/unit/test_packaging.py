"""What is written twice for those who package and cite, and says the same."""

from __future__ import annotations

import re
import tomllib

from conftest import ROOT

from scarid_cli import __version__

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
RECIPE = (ROOT / "packaging/conda/recipe.yaml").read_text("utf-8")
CONDA = {"matplotlib": "matplotlib-base"}  # the names that are others there


def test_the_version_is_the_same_everywhere() -> None:
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert re.findall(r"^version: (.+)$", citation, re.M) == [__version__]
    assert re.findall(r'^  version: "(.+)"$', RECIPE, re.M) == [__version__]


def test_the_conda_recipe_needs_what_the_wheel_needs() -> None:
    run = RECIPE.split("  run:\n")[1].split("  run_constraints:\n")[0]
    listed = dict(re.findall(r"- ([\w-]+) (>=[\d.]+)", run))
    wanted = dict(re.findall(r"([\w-]+)(>=[\d.]+)", "\n".join(PROJECT["dependencies"])))
    named = {CONDA.get(name, name): version for name, version in wanted.items()}
    assert listed == named | {"python": PROJECT["requires-python"]}


def test_the_paper_cites_what_it_lists() -> None:
    text = (ROOT / "paper/paper.md").read_text("utf-8")
    listed = re.findall(r"^@\w+\{(\w+),$", (ROOT / "paper/paper.bib").read_text("utf-8"), re.M)
    assert set(re.findall(r"@(\w+)", text)) == set(listed)
    assert len(listed) == len(set(listed))
    assert 750 <= len(text.split("---\n", 2)[2].split()) <= 1750  # the journal's limits
