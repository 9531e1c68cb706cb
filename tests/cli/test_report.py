"""`scarid report`: the same tables in three forms, and a page that needs nothing else."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import Result
from reports import (
    DIGEST,
    SCARA,
    column,
    estimates,
    markdown_rows,
    page_of,
    result_tables,
    write,
)

Run = Callable[..., Result]


@pytest.fixture
def tables(tmp_path: Path) -> list[Path]:
    return result_tables(tmp_path)


def test_terminal_markdown_and_page_hold_the_same_tables(
    tables: list[Path], tmp_path: Path, scarid: Run
) -> None:
    html, markdown = tmp_path / "r.html", tmp_path / "r.md"
    result = scarid("report", *tables, "--html", html, "--markdown", markdown)
    assert (result.status, result.err) == (0, "")
    rows = [row for row in markdown_rows(markdown.read_text()) if not row[0].startswith("---")]
    # The page shows the estimates with their intervals, every other table as the terminal does.
    others = [row for row in rows[9:] if row not in page_of(html).rows]
    assert others == []
    # The terminal shows a wide table in parts, each with the first column.
    lines = [re.split(r" {2,}", line) for line in result.out.splitlines()]
    shown = {row[0]: [cell for line in lines if line[0] == row[0] for cell in line] for row in rows}
    assert [row for row in rows if not set(row) <= set(shown[row[0]])] == []
    titles = ["Parameters", "Fit", "Estimates over time", "Torque prediction: direct"]
    assert re.findall(r"^## (.*)", markdown.read_text(), re.MULTILINE) == titles


def test_the_numbers_are_those_of_the_tables_in_the_order_of_the_files(
    tables: list[Path], scarid: Run
) -> None:
    rows = markdown_rows(scarid("report", *tables, "--markdown", "-").out)
    assert rows[0] == ["parameter", "unit", "a priori", "b-method", "%", "a-method", "%"]
    assert column(rows, "a priori", "parameter")["Fs1"] == "0.58"
    assert column(rows, "b-method", "parameter")["ZZ1R"] == "3.762"
    assert column(rows, "%", "parameter")["Fs1"] == "41.25"
    assert column(rows, "%", "parameter")["L1MY2"] == "-"
    assert column(rows, "residual deviation [N m]", "method")["a-method"] == "0.5123"
    assert column(rows, "tau1 R2", "method") == {"b-method": "0.9612", "a-method": "0.9612"}
    assert column(rows, "tau2 R2", "method") == {"b-method": "-", "a-method": "-"}


def test_the_error_of_a_trace_is_the_rms_over_the_record(tables: list[Path], scarid: Run) -> None:
    rows = markdown_rows(scarid("report", *tables, "--markdown", "-").out)
    for method, scale in (("b-method", 1.1), ("a-method", 0.9)):
        errors = estimates(scale) - SCARA.apriori[:, None]
        for parameter, expected in zip(
            SCARA.parameters, np.sqrt(np.mean(errors**2, axis=1)), strict=True
        ):
            shown = column(rows, f"{parameter.name} [{parameter.unit}]", "method")[method]
            assert float(shown) == pytest.approx(expected, rel=5e-4)


def test_the_page_needs_nothing_else(tables: list[Path], tmp_path: Path, scarid: Run) -> None:
    html = tmp_path / "r.html"
    assert scarid("report", *tables, "--html", html).status == 0
    page = page_of(html)
    assert "http" not in html.read_text().replace("http-equiv", "")
    assert {"link", "img", "iframe"}.isdisjoint(page.tags)
    assert not re.search(r"fetch\(|XMLHttp|import |@import|https?:", html.read_text())
    assert len(set(page.ids)) == len(page.ids)
    assert {reference.lstrip("#") for reference in page.references} <= set(page.ids)
    # First screen; intervals; torques of two methods; estimates over time.
    assert page.tags.count("figure") == page.tags.count("figcaption") == 5
    assert html.stat().st_size < 300_000


def test_two_runs_give_the_same_bytes(tables: list[Path], tmp_path: Path, scarid: Run) -> None:
    made = [(tmp_path / f"{i}.html", tmp_path / f"{i}.md") for i in (1, 2)]
    for html, markdown in made:
        assert scarid("report", *tables, "--html", html, "--markdown", markdown).status == 0
    for first, second in zip(*made, strict=True):
        assert first.read_bytes() == second.read_bytes()


def test_the_page_lists_how_each_table_was_made(
    tables: list[Path], tmp_path: Path, scarid: Run
) -> None:
    html = tmp_path / "r.html"
    scarid("report", *tables[:2], "--html", html)
    text = page_of(html).text
    for path in tables[:2]:
        assert str(path) in text
    assert "scarid filter 'a & b.csv'" in text
    assert DIGEST in text
    assert text.count("scarid identify") == 1  # one history for both


def test_what_a_file_says_is_escaped(tables: list[Path], tmp_path: Path, scarid: Run) -> None:
    rude = tables[0].rename(tmp_path / '<script>"&|$x^$.parquet')
    html, markdown = tmp_path / "r.html", tmp_path / "r.md"
    result = scarid("report", rude, "--html", html, "--markdown", markdown, "--title", "<i>T&")
    assert (result.status, result.err) == (0, "")
    page = page_of(html)
    assert "i" not in page.tags
    assert page.tags.count("script") == 1
    assert '<script>"&|$x^$' in page.rows[0]
    assert "<i>T&" in page.text
    assert '\\<script>"&\\|\\$x^\\$' in markdown.read_text()


def test_a_csv_is_known_by_its_columns_and_takes_the_robot_of_another_table(
    tables: list[Path], tmp_path: Path, scarid: Run
) -> None:
    csv = tmp_path / "c.trace.csv"
    scarid("convert", tables[1], "-o", csv)
    alone = scarid("report", csv)
    assert (alone.status, alone.out) == (0, "")
    assert "--html" in alone.err
    rows = markdown_rows(scarid("report", csv, tables[0], tables[1], "--markdown", "-").out)
    shown = column(rows, "ZZ1R [kg m2]", "method")
    assert shown["c"] == shown["b-method"]


def test_standard_input_is_the_default(tables: list[Path], shell: Run) -> None:
    result = shell(f"scarid convert {tables[0]} | scarid report")
    assert result.status == 0
    assert result.out.startswith("Parameters\n")
    assert "stdin" in result.out


def test_predictions_alone_are_reported_to_need_the_page(
    tables: list[Path], tmp_path: Path, scarid: Run
) -> None:
    result = scarid("report", tables[3])
    assert (result.status, result.out) == (0, "")
    assert result.err.count("\n") == 1
    assert "--html" in result.err
    assert scarid("report", "-q", tables[3]).err == ""
    assert scarid("report", tables[3], "--html", tmp_path / "r.html").err == ""


def test_the_tables_alone_load_no_plotting(tables: list[Path]) -> None:
    script = (
        "import sys; from scarid_cli.__main__ import main; assert main(sys.argv[1:]) == 0;"
        "assert not {'matplotlib', 'jinja2', 'scipy'} & set(sys.modules)"
    )
    subprocess.run(
        [sys.executable, "-c", script, "report", *tables], check=True, stdout=subprocess.DEVNULL
    )


def test_a_long_record_makes_a_small_page(tmp_path: Path, scarid: Run) -> None:
    t = np.arange(300_000) * 0.001
    noise = np.random.default_rng(0).standard_normal(len(t))
    path = write(tmp_path / "m.trace.parquet", "trace", {"t": t, "p": noise})
    html = tmp_path / "r.html"
    assert scarid("report", path, "--html", html).status == 0
    assert html.stat().st_size < 150_000


def test_tables_that_have_no_place_in_a_report_are_skipped_with_a_note(
    scarid: Run, samples: Path, tmp_path: Path
) -> None:
    """And the printed tables go to a file."""
    reference, place = tmp_path / "reference.parquet", tmp_path / "report.txt"
    assert scarid("trajgen", "-q", "--robot", "scara2", "-o", reference).status == 0
    parameters = samples / "scara2.parameters.csv"
    alone = scarid("report", parameters)
    both = scarid("report", parameters, reference, "-o", place)
    assert (both.status, both.out) == (0, "")
    assert place.read_text("utf-8") == alone.out
    assert f"skipped: {reference} is a trajectory table" in both.err
