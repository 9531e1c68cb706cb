"""What the tests of the report share: tables to report, results, and readers of documents."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from scarid_cli.algorithms.robots import reading
from scarid_cli.io.table import METADATA_KEY, Metadata
from scarid_cli.reporting import figures
from scarid_cli.reporting.content import sections
from scarid_cli.reporting.kinds import Parameters, Trace
from scarid_cli.reporting.naming import Name
from scarid_cli.reporting.parts import Panels

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


def result_tables(folder: Path) -> list[Path]:
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
            write(folder / f"{method}.parameters.parquet", "parameters", parameters, extra=extra),
            write(folder / f"{method}.trace.parquet", "trace", trace),
            write(folder / f"{method}.direct.metrics.parquet", "metrics", metrics),
            write(folder / f"{method}.direct.prediction.parquet", "prediction", prediction),
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


def a_line(*values: float) -> np.ndarray:
    return np.array([np.arange(len(values), dtype=float), values])


def parameters(
    label: str, *, deviations: tuple[float, ...] = (1.0, 2.0), **more: str
) -> Parameters:
    name = Name(label, more.get("experiment", "direct"))
    return Parameters(
        name, None, ("ZZ1R", "Fv1"), ("kg m2", "N m s/rad"), (3.4, 0.07), deviations, {}
    )


def element_of(plot: Any) -> str:
    return figures.element(figures.draw(plot))


def evolution(values: np.ndarray, *, level: bool = True) -> Panels:
    robot = SCARA if level else None
    curves = (a_line(*values),) * 8
    trace = Trace(Name("a", ""), robot, tuple(SCARA.names), ("",) * 8, curves, (0.0,) * 8)
    (plot,) = sections([trace])[0].plots
    assert isinstance(plot, Panels)
    return plot
