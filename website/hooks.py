"""What MkDocs is told beyond mkdocs.yml: the navigation, generated pages, files outside `docs/`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))  # the package need not be installed, and its kernels not compiled

from dialect import adapted  # noqa: E402
from navigation import INDEX, navigation, pages  # noqa: E402
from reference import reference  # noqa: E402
from relinking import first_part, outside, relinked, title  # noqa: E402

GENERATED = reference()
OUTSIDE = outside(ROOT)
SOURCES = {site: path for path, site in OUTSIDE.items()}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """The navigation, of the pages that there are."""
    there = [*pages(ROOT / "docs"), *GENERATED, *(p for p in SOURCES if p.endswith(".md"))]
    sections = [{title: _items(found)} for title, found in navigation(there).items() if found]
    config.nav = [{"Start": INDEX}, *sections]
    return config


def _items(found: list[str]) -> list[Any]:
    """The pages of a section; those of the commands fold."""
    commands = [page for page in found if page.startswith("reference/commands/")]
    rest: list[Any] = [page for page in found if page not in commands]
    return [{"Commands": commands}, *rest] if commands else rest


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Pages that are made, and files of the repository that pages lead to."""
    for name, text in GENERATED.items():
        files.append(File.generated(config, name, content=text))
    for path, name in OUTSIDE.items():
        source = str(ROOT / path)
        files.append(
            File.generated(config, name, abs_src_path=source, inclusion=InclusionLevel.INCLUDED)
        )
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:  # noqa: ARG001
    """A page, with the links that it has on the site."""
    name = page.file.src_uri
    if name in GENERATED:
        return markdown
    source = SOURCES.get(name, f"docs/{name}")
    if name == INDEX:
        page.meta["hide"] = ["navigation"]  # the tabs say it
    text = first_part(markdown) if name == INDEX else markdown
    return adapted(relinked(text, source, lambda path: title(ROOT / path)))
