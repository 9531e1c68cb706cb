"""How a report is shown: names, numbers, tables split to fit, Markdown, text and figures."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reports import element_of, evolution, parameters

from scarid_cli.reporting import text
from scarid_cli.reporting.content import sections
from scarid_cli.reporting.naming import Name, name_of, names_of
from scarid_cli.reporting.parts import Section, number, split


@pytest.mark.parametrize(
    ("file", "kind", "label", "experiment"),
    [
        ("p2smd.direct.metrics.parquet", "metrics", "p2smd", "direct"),
        ("a/b.c/ed-fir.cross.predictions.csv", "prediction", "ed-fir", "cross"),
        ("p2smd.parameters.parquet", "parameters", "p2smd", ""),
        ("p2smd.parquet", "trace", "p2smd", ""),
        ("metrics.csv", "metrics", "metrics", ""),
        ("x.run.2.trace.arrows", "trace", "x", "run.2"),
        ("/dev/fd/63", "trace", "63", ""),
        (".hidden.csv", "trace", ".hidden.csv", "hidden"),
        ("<stdin>", "trace", "stdin", ""),
        ("a\x1b[1m.csv", "trace", "a\\x1b[1m", ""),
    ],
)
def test_a_file_name_states_method_and_experiment(
    file: str, kind: str, label: str, experiment: str
) -> None:
    assert name_of(file, kind) == Name(label, experiment)


def test_equal_labels_are_distinguished_by_folder_then_by_file() -> None:
    files = ["r1/m.csv", "r2/m.csv", "r1/m.trace.csv", "n.csv"]
    kinds = ["parameters", "parameters", "trace", "parameters"]
    labels = [name.label for name in names_of(files, kinds)]
    assert labels == ["r1/m", "r2/m", "r1/m", "n"]
    same = names_of(["m.csv", "m.parquet"], ["trace", "trace"])
    assert [name.label for name in same] == ["m.csv", "m.parquet"]


@given(st.floats(-1e300, 1e300))
def test_numbers_have_four_significant_digits(value: float) -> None:
    shown = number(value)
    assert len(re.sub(r"e.*|[-.]", "", shown).lstrip("0")) <= 4
    # Below the normal range a double itself has fewer digits.
    assert float(shown) == pytest.approx(value, rel=5.001e-4, abs=1e-300)


def test_what_is_not_a_number_is_a_dash_and_counts_are_whole() -> None:
    values = [float("nan"), float("inf"), None, "text", 123456, 1234.0, -0.0]
    assert [number(v) for v in values] == ["-", "-", "-", "-", "123456", "1234", "0.000"]


words = st.text(min_size=1, max_size=12)
tables = st.integers(1, 9).flatmap(
    lambda columns: st.tuples(
        st.tuples(*[words] * (1 + 2 * columns)),
        st.lists(st.tuples(*[words] * (1 + 2 * columns)), min_size=1, max_size=3),
    )
)


@given(tables, st.integers(10, 120))
def test_a_split_table_has_every_column_once_and_fits(
    table: tuple[tuple[str, ...], list[tuple[str, ...]]], width: int
) -> None:
    headers, rows = table
    section = Section("t", "", headers, tuple(rows), keys=1, group=2)
    parts = split(section, width)
    for row, of_parts in zip(
        (headers, *rows), zip(*((p.headers, *p.rows) for p in parts), strict=True), strict=True
    ):
        assert row == (row[0], *(cell for part in of_parts for cell in part[1:]))
        assert all(part[0] == row[0] for part in of_parts)
    for part in parts:
        columns = zip(part.headers, *part.rows, strict=True)
        fits = sum(max(map(len, column)) + 2 for column in columns) <= width
        assert fits or len(part.headers) == 3  # a group is never split


def parsed(markdown: str) -> list[list[str]]:
    """The cells of a pipe table, without escapes; independent of how it was padded."""
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    rows = [re.split(r"(?<!\\)\|", line)[1:-1] for line in lines]
    return [[re.sub(r"\\(.)", r"\1", cell.strip()) for cell in row] for row in rows]


cells = st.text(st.characters(categories=["L", "N", "P", "S"], exclude_characters="\\"), min_size=1)


@given(st.lists(st.tuples(cells, cells), min_size=2, max_size=4))
def test_markdown_reads_back_as_the_table(rows: list[tuple[str, ...]]) -> None:
    document = text.markdown("Title", [Section("S", "Note.", rows[0], tuple(rows[1:]))])
    header, rule, *body = parsed(document)
    assert [tuple(row) for row in (header, *body)] == rows
    assert rule[0].startswith("--")
    assert rule[1].endswith("-:")


def test_text_without_a_terminal_is_plain_and_never_cut() -> None:
    many = [parameters(f"a-long-name-{i}") for i in range(20)]
    shown = text.terminal(sections(many))
    assert not re.search(r"[…\x1b]|[ ]$", shown, re.MULTILINE)
    assert shown.count("3.400") == 20


def test_a_figure_is_the_same_every_time_and_refers_to_nothing() -> None:
    plots = [p for s in sections([parameters("$a_b$"), parameters("_日本")]) for p in s.plots]
    plots.append(evolution(np.arange(30.0)))
    for plot in plots:
        drawn = element_of(plot)
        assert drawn == element_of(plot)
        assert drawn.startswith("<svg")
        assert drawn.endswith("</svg>")
        assert "http" not in drawn
        assert "<script" not in drawn
