"""Links of the repository, on the site: what stands outside `docs/` comes along.

On the site `docs/` is the root, the start page is the first part of the README, and any other file
that a page names stands below `repository/`.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable
from pathlib import Path, PurePosixPath

from navigation import INDEX

# A link or picture of Markdown, or of HTML in it; code is left alone.
LINK = re.compile(
    r"(?P<code>^ *```.*?^ *```$|`[^`\n]*`)"
    r"|(?P<start>(?:\[(?P<text>[\w/.-]+\.md))?\]\(|(?:src|srcset|href)=\")(?P<target>[^)\s\"#]+)(?P<anchor>#[^)\s\"]*)?",
    re.DOTALL | re.MULTILINE,
)
LAST_OF_INDEX = "\n## The commands\n"  # from here on, the navigation says it


def place(path: str) -> str:
    """Where a file of the repository stands on the site."""
    if path == "README.md":
        return INDEX
    return path.removeprefix("docs/") if path.startswith("docs/") else f"repository/{path}"


def targets(text: str, source: str) -> set[str]:
    """The files of the repository that the text of a file refers to."""
    found = (_file(match, source) for match in LINK.finditer(text))
    return {path for path in found if path}


def relinked(text: str, source: str, titles: Callable[[str], str]) -> str:
    """The text of a file of the repository, with the links that it has on the site.

    Where a link says the name of a page, the site says its title, as `titles` has it.
    """
    here = posixpath.dirname(place(source))

    def moved(match: re.Match[str]) -> str:
        path = _file(match, source)
        if not path:
            return match[0]
        there = posixpath.relpath(place(path), here or ".")
        start = f"[{titles(path)}](" if match["text"] else match["start"]
        return f"{start}{there}{match['anchor'] or ''}"

    return LINK.sub(moved, text)


def _file(match: re.Match[str], source: str) -> str | None:
    """The file of the repository that a link refers to, if it is one."""
    target = match["target"]
    if match["code"] or not target or ":" in target:
        return None
    return posixpath.normpath(posixpath.join(posixpath.dirname(source), target))


def title(page: Path) -> str:
    """The first heading of a page."""
    lines = page.read_text("utf-8").splitlines() if page.is_file() else []
    return next((line[2:] for line in lines if line.startswith("# ")), page.name)


def first_part(readme: str) -> str:
    """The README, as far as the navigation of the site does not say the same."""
    return readme.split(LAST_OF_INDEX)[0] + "\n"


def outside(root: Path) -> dict[str, str]:
    """The files outside `docs/` that pages lead to, directly or through others: path to place."""
    found: dict[str, str] = {}
    waiting = {"README.md", "CHANGELOG.md", "CONTRIBUTING.md", "DESIGN.md"}
    waiting |= {path.relative_to(root).as_posix() for path in (root / "docs").rglob("*.md")}
    seen: set[str] = set()
    while waiting:
        path = waiting.pop()
        seen.add(path)
        if not (root / path).is_file():
            continue  # MkDocs says which link is broken
        if not path.startswith("docs/"):
            found[path] = place(path)
        if PurePosixPath(path).suffix == ".md":
            waiting |= targets((root / path).read_text("utf-8"), path) - seen
    return found
