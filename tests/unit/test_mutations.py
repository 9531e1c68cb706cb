"""The changes of `make mutants`: one operator each, where it stands, and which tests reach it."""

from __future__ import annotations

import ast

import mutants
import pytest
from conftest import ALL, ROOT
from mutations import lines_of, mutations

TEXT = '''"""A module; 1 < 2 here is no code."""
from __future__ import annotations
LIMIT = 3
def chosen(a: int = 1, b: list[int] | None = None) -> int:
    if a < LIMIT and (b is not None  # < here neither
            and not (a == 2)):
        print(f"{a + 1} of é",
              "é")
        return a - 1 + len(b[a:])
    raise ValueError("none")
'''
EXPECTED = {
    "3": "4", "1": "2", "2": "3", "<": "<=", "and": "or", "is not": "is", "not ": "", "==": "!=",
    "-": "+", "+": "-", "a": "(a) + 1",
    'print(f"{a + 1} of é",\n              "é")': "pass\n",
    'raise ValueError("none")': "pass",
}  # fmt: skip


def test_every_operator_is_changed_once_and_no_line_moves() -> None:
    found = mutations("module.py", TEXT)
    assert {mutation.old: mutation.new for mutation in found} == EXPECTED
    for mutation in found:
        changed = mutation.applied(TEXT)
        assert len(changed.splitlines()) == len(TEXT.splitlines())
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(TEXT))
        assert mutation.old.splitlines()[0] in TEXT.splitlines()[mutation.line - 1]


@pytest.mark.parametrize(
    ("line", "lines"),
    [(3, None), (4, None), (5, [5, 6]), (6, [5, 6]), (8, [7, 8]), (9, [9]), (10, [10])],
)
def test_a_line_is_reached_by_the_lines_of_its_statement(
    line: int, lines: list[int] | None
) -> None:
    """What is evaluated at import, such as defaults, is reached by all tests of the module."""
    found = lines_of(TEXT, line)
    assert (None if found is None else list(found)) == lines


def test_the_changes_that_once_passed_all_tests_are_still_places_of_the_program() -> None:
    for file, old, new in mutants.FORMER:
        text = (ROOT / file).read_text("utf-8")
        assert text.count(old) == 1, (file, old)
        ast.parse(text.replace(old, new))


def test_every_change_of_the_program_is_python() -> None:
    every = 1 if ALL else 25
    for path in sorted((ROOT / "scarid_cli" / "io").glob("*.py")):
        text = path.read_text("utf-8")
        for mutation in list(mutations(path.name, text))[::every]:
            ast.parse(mutation.applied(text))
