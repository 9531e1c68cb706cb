"""`scarid report`: the same tables three ways, a page that needs nothing else, honest failures."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from conftest import Result, refused

from scarid_cli.algorithms.robots import reading
from scarid_cli.io.table import METADATA_KEY, Metadata

Run = Callable[..., Result]
SCARA = reading.load("scara2")
DIGEST = "0123456789abcdef" * 4
HISTORY = (
    {"command": "scarid filter 'a & b.csv'", "version": "0.1.0", "inputs": {"a & b.csv": DIGEST}},
    {"command": "scarid identify", "version": "0.1.0", "inputs": {"<stdin>": None}},
)
T = np.arange(1200) * 0.005


def write(path: Path, kind: str | None, columns: Mapping[str, Any], **meta: Any) -> Path:
    document = Metadata(kind=kind, robot="scara2" if kind else None, history=HISTORY, **meta)
    table = pa.table(dict(columns)).replace_schema_metadata({METADATA_KEY: document.to_json()})
    pq.write_table(table, path)
    return path


def estimates(scale: float) -> np.ndarray:
    """Running estimates (parameters, samples) that approach scaled a priori values."""
    return scale * SCARA.apriori[:, None] + np.outer(np.arange(1.0, 9.0), np.exp(-T))


@pytest.fixture
def tables(tmp_path: Path) -> list[Path]:
    """One table of each kind for two methods."""
    paths = []
    for method, scale in (("b-method", 1.1), ("a-method", 0.9)):
        parameters = {
            "parameter": SCARA.names,
            "unit": [p.unit for p in SCARA.parameters],
            "estimate": scale * SCARA.apriori,
            "standard_error": np.full(8, 0.01),
            "relative_deviation": pa.array([1.5, 2.5, 41.25, 4.5, 5.5, None, 7.5, 8.5]),
        }
        trace = dict(zip(["t", *SCARA.names], [T, *estimates(scale)], strict=True))
        metrics = {
            "joint": [1, 2],
            "r2": [0.96123, None],
            "rmse": [1.23456, 0.1],
            "unit": ["N m", "N m"],
            "relative_error": [12.0, 34.0],
            "samples": [1200, 1200],
        }
        tau = {f"tau{i}": np.sin(i * T) for i in (1, 2)}
        prediction = {"t": T, **tau, **{f"{k}_pred": scale * x for k, x in tau.items()}}
        extra = {"condition_number": 14.881, "samples": 1200, "residual_deviation": 0.51234}
        paths += [
            write(tmp_path / f"{method}.parameters.parquet", "parameters", parameters, extra=extra),
            write(tmp_path / f"{method}.trace.parquet", "trace", trace),
            write(tmp_path / f"{method}.direct.metrics.parquet", "metrics", metrics),
            write(tmp_path / f"{method}.direct.prediction.parquet", "prediction", prediction),
        ]
    return paths


@dataclass
class Page(HTMLParser):
    """What a browser would make of a page: tables, identifiers and references."""

    rows: list[list[str]] = field(default_factory=list)
    ids: list[str] = field(default_factory=list)
    references: list[str] = field(default_factory=list)
    tags: list[str] = field(default_factory=list)
    text: str = ""
    in_cell: bool = False

    def __post_init__(self) -> None:
        super().__init__()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")
            self.in_cell = True
        for name, value in attrs:
            self.ids += [value or ""] if name == "id" else []
            self.references += [value or ""] if name in ("href", "src", "xlink:href") else []
            self.references += re.findall(r"url\(([^)]*)\)", value or "")

    def handle_endtag(self, tag: str) -> None:
        self.in_cell = self.in_cell and tag not in ("td", "th")

    def handle_data(self, data: str) -> None:
        self.text += data
        if self.in_cell:
            self.rows[-1][-1] += data.replace("\N{NO-BREAK SPACE}", " ")


def page_of(path: Path) -> Page:
    page = Page()
    page.feed(path.read_text("utf-8"))
    return page


def markdown_rows(document: str) -> list[list[str]]:
    lines = [line for line in document.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def column(rows: list[list[str]], header: str, first: str) -> dict[str, str]:
    """The cells under a header, by row, of the table whose first header is `first`."""
    start = next(i for i, row in enumerate(rows) if row[0] == first and header in row)
    at = rows[start].index(header)
    found: dict[str, str] = {}
    for row in rows[start + 2 :]:
        if row[0] in ("parameter", "method"):
            break
        found[row[0]] = row[at]
    return found


def test_terminal_markdown_and_page_hold_the_same_tables(
    tables: list[Path], tmp_path: Path, scarid: Run
) -> None:
    html, markdown = tmp_path / "r.html", tmp_path / "r.md"
    result = scarid("report", *tables, "--html", html, "--markdown", markdown)
    assert (result.status, result.err) == (0, "")
    rows = [row for row in markdown_rows(markdown.read_text()) if not row[0].startswith("---")]
    assert page_of(html).rows == rows
    lines = [re.split(r" {2,}", line) for line in result.out.splitlines()]
    assert [row for row in rows if row not in lines] == []
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
    assert "http" not in html.read_text()
    assert {"script", "link", "img", "iframe"}.isdisjoint(page.tags)
    assert len(set(page.ids)) == len(page.ids)
    assert {reference.lstrip("#") for reference in page.references} <= set(page.ids)
    # Bars; estimates over time; torques of two methods.
    assert page.tags.count("svg") == page.tags.count("figcaption") == 4
    assert html.stat().st_size < 500_000


def test_two_runs_give_the_same_bytes(tables: list[Path], tmp_path: Path, scarid: Run) -> None:
    made = [(tmp_path / f"{i}.html", tmp_path / f"{i}.md") for i in (1, 2)]
    for html, markdown in made:
        assert scarid("report", *tables, "--html", html, "--markdown", markdown).status == 0
    for first, second in zip(*made, strict=True):
        assert first.read_bytes() == second.read_bytes()


def test_the_page_tells_how_each_table_was_made(
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
    assert {"script", "i"}.isdisjoint(page.tags)
    assert '<script>"&|$x^$' in page.rows[0]
    assert "<i>T&" in page.text
    assert '\\<script>"&\\|$x^$' in markdown.read_text()


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


def test_predictions_alone_are_told_to_need_the_page(
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


# --- failures -----------------------------------------------------------------------------------


def test_a_trajectory_is_no_result(tmp_path: Path, scarid: Run) -> None:
    path = tmp_path / "reference.csv"
    assert scarid("trajgen", "-q", "--duration", 2, "-o", path).status == 0
    refused(scarid("report", path), 2, str(path), "trajectory", "parameters, trace, metrics, ")


@pytest.mark.parametrize("kind", [None, "recipe"])
def test_a_table_of_unknown_kind_is_bad_data(kind: str | None, tmp_path: Path, scarid: Run) -> None:
    path = write(tmp_path / "x.parquet", kind, {"a": [1.0]})
    refused(scarid("report", path), 65, str(path), "expected")


def test_a_table_given_twice_is_refused(tables: list[Path], scarid: Run) -> None:
    refused(scarid("report", tables[0], tables[0]), 2, str(tables[0]), "twice")
    refused(scarid("report", "-", "-"), 2, "- is given twice")


def test_two_documents_in_one_file_are_refused(tables: list[Path], scarid: Run) -> None:
    refused(scarid("report", tables[0], "--html", "x", "--markdown", "x"), 2, "two files")


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"t": [0.0, 1.0], "p": [1.0, float("nan")]}, ["row 2", "column p", "finite"]),
        ({"t": [0.0, 1.0], "p": pa.array([None, 1.0])}, ["row 1", "column p", "empty"]),
        ({"t": [0.0, 1.0], "p": ["a", "b"]}, ["column p", "string"]),
        ({"t": [0.0, 1.0]}, ["column t alone"]),
        ({"t": [1.0, 0.0], "p": [1.0, 1.0]}, ["row 2", "column t"]),
    ],
)
def test_a_bad_trace_is_told_by_row_and_column(
    columns: dict[str, Any], told: list[str], tmp_path: Path, scarid: Run
) -> None:
    path = write(tmp_path / "m.trace.parquet", "trace", columns)
    refused(scarid("report", path), 65, str(path), *told)


def test_a_prediction_without_a_joint_is_told(tmp_path: Path, scarid: Run) -> None:
    columns = {"t": [0.0, 1.0], "tau1": [1.0, 1.0], "tau1_pred": [1.0, 1.0], "tau2": [1.0, 1.0]}
    path = write(tmp_path / "m.parquet", "prediction", columns)
    refused(scarid("report", path), 65, str(path), "tau2_pred")


def test_parameters_without_rows_are_told(tmp_path: Path, scarid: Run) -> None:
    path = tmp_path / "m.csv"
    path.write_text("parameter,unit,estimate\n")
    refused(scarid("report", path), 65, str(path), "no rows")


def test_a_failure_leaves_what_was_there(tables: list[Path], tmp_path: Path, scarid: Run) -> None:
    old, new = tmp_path / "old.html", tmp_path / "new.md"
    old.write_text("kept")
    bad = write(tmp_path / "z.trace.parquet", "trace", {"t": [0.0, 1.0], "p": [1.0, np.inf]})
    before = sorted(tmp_path.iterdir())
    refused(scarid("report", *tables, bad, "--html", old, "--markdown", new), 65, str(bad))
    assert old.read_text() == "kept"
    assert sorted(tmp_path.iterdir()) == before


def test_a_place_that_cannot_be_written_is_told_first(tables: list[Path], scarid: Run) -> None:
    refused(scarid("report", __file__, "--html", "/nowhere/r.html"), 74, "/nowhere/r.html")
    refused(scarid("report", tables[0], "--html", "/dev/full"), 74, "/dev/full")
