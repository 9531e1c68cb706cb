"""Changes of a single operator in a Python file, each as the file's new text.

The text is changed in place, so that no line moves, and the tests that reach a line are known.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

COMPARISONS = {
    ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="), ast.NotEq: ("!=", "=="), ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"), ast.In: ("in", "not in"), ast.NotIn: ("not in", "in"),
}  # fmt: skip
SIGNS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+")}
WORDS = {ast.And: ("and", "or"), ast.Or: ("or", "and")}


@dataclass(frozen=True, order=True)
class Mutation:
    """One change: characters `start` to `end` of the file become `new`; the line is from 1."""

    file: str
    line: int
    start: int
    end: int
    old: str
    new: str
    kind: str

    def applied(self, text: str) -> str:
        assert text[self.start : self.end] == self.old
        return text[: self.start] + self.new + text[self.end :]


class Source:
    """A file and where its nodes are, in characters."""

    def __init__(self, file: str, text: str) -> None:
        self.file = file
        self.text = text
        self._starts = [0]
        for line in text.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        self._lines = text.splitlines()

    def place(self, line: int, column: int) -> int:
        """The character at a column, which ast counts in bytes."""
        before = self._lines[line - 1].encode()[:column].decode()
        return self._starts[line - 1] + len(before)

    def start(self, node: ast.AST) -> int:
        return self.place(node.lineno, node.col_offset)  # type: ignore[attr-defined]

    def end(self, node: ast.AST) -> int:
        return self.place(node.end_lineno, node.end_col_offset)  # type: ignore[attr-defined]

    def line(self, place: int) -> int:
        return self.text.count("\n", 0, place) + 1

    def change(self, start: int, end: int, new: str, kind: str) -> Mutation:
        old = self.text[start:end]
        return Mutation(self.file, self.line(start), start, end, old, new, kind)

    def between(self, left: ast.AST, right: ast.AST, old: str, new: str, kind: str) -> Mutation:
        """The operator between two operands; brackets and comments may stand there too."""
        first, last = self.end(left), self.start(right)
        gap = re.sub(r"#[^\n]*", lambda found: " " * len(found[0]), self.text[first:last])
        word = r"\s+".join(map(re.escape, old.split()))
        bounded = rf"\b{word}\b" if old[0].isalpha() else word
        found = re.search(bounded, gap)
        assert found, (self.file, left.lineno, old, gap)  # type: ignore[attr-defined]
        return self.change(first + found.start(), first + found.end(), new, kind)


def mutations(file: str, text: str) -> list[Mutation]:
    """All changes of one operator, constant, call or slice of a file, in order."""
    source = Source(file, text)
    return sorted(set(_of_node(source, ast.parse(text))))


def _of_node(source: Source, node: ast.AST) -> Iterator[Mutation]:
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "type_comment", "type_params"):
            continue  # annotations are never evaluated
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not _passed_over(child):
                yield from _of_node(source, child)
    yield from _changes(source, node)


def _passed_over(node: ast.AST) -> bool:
    """Imports for types only, and texts with values: ast misplaces what is in those."""
    for_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    return for_types or isinstance(node, ast.JoinedStr)


def _changes(source: Source, node: ast.AST) -> Iterator[Mutation]:
    """The changes of this node itself."""
    match node:
        case ast.Compare() | ast.BinOp(op=ast.Add() | ast.Sub()) | ast.BoolOp():
            yield from _operators(source, node)
        case ast.UnaryOp(op=ast.Not()):
            start = source.start(node)
            yield source.change(start, start + len("not "), "", "not")
        case ast.Constant(value=int() | float()) if not isinstance(node.value, bool):
            new = repr(node.value + 1)
            yield source.change(source.start(node), source.end(node), new, "constant")
        case ast.Expr(value=ast.Call()):
            yield _removed(source, node, "call")
        case ast.Raise():
            yield _removed(source, node, "raise")
        case ast.Slice():
            yield from _slices(source, node)


def _operators(source: Source, node: ast.Compare | ast.BinOp | ast.BoolOp) -> Iterator[Mutation]:
    if isinstance(node, ast.Compare):
        operands = [node.left, *node.comparators]
        for left, right, kind in zip(operands, operands[1:], node.ops, strict=False):
            yield source.between(left, right, *COMPARISONS[type(kind)], "comparison")
    elif isinstance(node, ast.BoolOp):
        for left, right in pairwise(node.values):
            yield source.between(left, right, *WORDS[type(node.op)], "and/or")
    elif not _of_text(node):
        yield source.between(node.left, node.right, *SIGNS[type(node.op)], "sign")


def _slices(source: Source, node: ast.Slice) -> Iterator[Mutation]:
    """Bounds that are one higher; those that are constants are changed as constants."""
    for bound in (node.lower, node.upper):
        if bound is not None and not isinstance(bound, ast.Constant):
            start, end = source.start(bound), source.end(bound)
            yield source.change(start, end, f"({source.text[start:end]}) + 1", "slice")


def _of_text(node: ast.BinOp) -> bool:
    """Whether an operand is a text: its difference would be a TypeError, which tells nothing."""
    texts = (ast.JoinedStr, ast.List, ast.Tuple)
    return any(
        isinstance(side, texts) or (isinstance(side, ast.Constant) and isinstance(side.value, str))
        for side in (node.left, node.right)
    )


def _removed(source: Source, node: ast.AST, kind: str) -> Mutation:
    """Without a statement; its other lines remain, empty."""
    start, end = source.start(node), source.end(node)
    return source.change(start, end, "pass" + "\n" * source.text.count("\n", start, end), kind)


def lines_of(text: str, line: int) -> range | None:
    """The lines of the statement at a line, without its block; None if it runs at import.

    Tests reach a statement by any of its lines.
    """
    inside, found = False, None
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.stmt) or not node.lineno <= line <= (node.end_lineno or 0):
            continue
        block = getattr(node, "body", None)
        last = block[0].lineno - 1 if block else node.end_lineno or line
        if isinstance(node, ast.FunctionDef) and line > last:
            inside = True
        if line <= last or not block:
            found = range(node.lineno, max(last, node.lineno) + 1)
    return (found or range(line, line + 1)) if inside else None
