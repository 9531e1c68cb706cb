"""Lines of code of two revisions, package by package: `python benchmarks/lines.py OLD [NEW]`.

Blank lines, comments, docstrings and imports do not count, and neither do the tests.
"""

from __future__ import annotations

import argparse
import ast
import io
import subprocess
import tarfile
import tokenize
from collections import Counter
from pathlib import PurePath

SILENT = {
    tokenize.COMMENT,
    tokenize.DEDENT,
    tokenize.ENDMARKER,
    tokenize.INDENT,
    tokenize.NEWLINE,
    tokenize.NL,
}
DOCUMENTED = ast.Module | ast.ClassDef | ast.FunctionDef


def counted(source: str) -> int:
    """The lines of code of one module."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in SILENT:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import | ast.ImportFrom):
            lines.difference_update(range(node.lineno, (node.end_lineno or 0) + 1))
        elif isinstance(node, DOCUMENTED) and ast.get_docstring(node):
            text = node.body[0]
            lines.difference_update(range(text.lineno, (text.end_lineno or 0) + 1))
    return len(lines)


def packages(revision: str) -> Counter[str]:
    """The lines of code of each package at a revision."""
    command = ["git", "archive", revision, "scarid_cli"]
    archive = subprocess.run(command, check=True, capture_output=True).stdout
    found: Counter[str] = Counter()
    with tarfile.open(fileobj=io.BytesIO(archive)) as tar:
        for member in tar.getmembers():
            content = tar.extractfile(member) if member.name.endswith(".py") else None
            if content:
                found[str(PurePath(member.name).parent)] += counted(content.read().decode())
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("old")
    parser.add_argument("new", nargs="?", default="HEAD")
    given = parser.parse_args()
    old, new = packages(given.old), packages(given.new)
    for name in sorted({*old, *new}):
        print(f"{name:40} {old[name]:6} {new[name]:6} {new[name] - old[name]:+6}")
    print(f"{'total':40} {old.total():6} {new.total():6} {new.total() - old.total():+6}")


if __name__ == "__main__":
    main()
