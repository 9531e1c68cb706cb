"""The page of one study: what its first screen answers, and what its figures promise."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from conftest import Result
from reports import SCARA, page_of, result_tables, write

from scarid_cli.reporting.study.colours import DASHES, PALETTE, colours_of, rules
from scarid_cli.reporting.study.forest import LEADERS

Run = Callable[..., Result]
VOID = {"meta", "input", "br", "link", "img", "hr"}


@pytest.fixture
def study(tmp_path: Path, scarid: Run) -> tuple[str, Path]:
    """A real log identified twice, with the page of it."""
    samples = Path(__file__).parents[2] / "samples" / "scara2.csv"
    motion = tmp_path / "motion.parquet"
    assert scarid("differentiate", samples, "-o", motion).status == 0
    for name, options in (("plain", ["--estimator", "ls", "--all-rows"]), ("best", [])):
        table = tmp_path / f"{name}.parameters.parquet"
        assert scarid("identify", "-q", motion, "-o", table, *options).status == 0
        validate = ("validate", "--parameters", table, motion)
        metrics, curves = (
            tmp_path / f"{name}.cross.{kind}.parquet" for kind in ("metrics", "prediction")
        )
        assert scarid(*validate, "-o", metrics, "--predictions", curves).status == 0
    html = tmp_path / "r.html"
    found = scarid(
        "report",
        *sorted(tmp_path.glob("*.p*.parquet")),
        *tmp_path.glob("*.metrics.parquet"),
        "--html",
        html,
    )
    assert found.status == 0, found.err
    return html.read_text("utf-8"), tmp_path


class Nesting(HTMLParser):
    """Whether every element is closed where it was opened."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.faults: list[str] = []

    def handle_starttag(self, tag: str, *_: object) -> None:
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, *_: object) -> None:
        if tag in ("div", "span", "section", "p"):
            self.faults.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if not self.open or self.open.pop() != tag:
            self.faults.append(tag)


def test_the_page_is_well_nested_and_its_anchors_lead_somewhere(study: tuple[str, Path]) -> None:
    html, folder = study
    nesting = Nesting()
    nesting.feed(html)
    assert (nesting.faults, nesting.open) == ([], [])
    page = page_of(folder / "r.html")
    anchors = [r.removeprefix("#") for r in page.references if r.startswith("#")]
    assert len(anchors) >= 4
    assert set(anchors) <= set(page.ids)


def test_the_first_screen_names_the_best_method_and_its_verdict(study: tuple[str, Path]) -> None:
    html, folder = study
    first = html[html.index('class="top"') : html.index("<nav")]
    extra = {n: page_of_verdict(folder / f"{n}.parameters.parquet") for n in ("best", "plain")}
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", first))
    assert "best is the best of 2 identifications" in text
    assert extra["best"] == "good"
    assert 'class="badge good"' in first
    for line in ("How well?", "another log within", "May I believe it?", "the next, plain"):
        assert line in text


def test_a_validation_of_any_name_is_that_of_the_only_identification(
    study: tuple[str, Path], scarid: Run
) -> None:
    _, folder = study
    other = (folder / "best.cross.metrics.parquet").rename(folder / "validation.parquet")
    html = folder / "one.html"
    tables = (folder / "best.parameters.parquet", other)
    assert scarid("report", *tables, "--html", html).status == 0
    page = html.read_text("utf-8")
    first = page[page.index('class="top"') : page.index("<nav")]
    assert "The estimates of best are good" in first
    assert "It predicts the torques of the log of the validation within" in first
    assert "identifications" not in first


def page_of_verdict(path: Path) -> str:
    import json

    meta = pq.read_schema(path).metadata
    return str(json.loads(next(iter(meta.values())))["extra"]["verdict"])


def test_intervals_of_the_forest_plot_are_those_of_the_table(study: tuple[str, Path]) -> None:
    html, folder = study
    rows = pq.read_table(folder / "best.parameters.parquet").to_pylist()
    for row in rows:
        (panel,) = [
            f
            for f in re.findall(r'<svg [^>]*class="forest".*?</svg>', html, re.DOTALL)
            if f'aria-label="{row["parameter"]} ' in f
        ]
        half = (row["high"] - row["low"]) / 2.0
        spoken = re.search(r"best (-?[\d.,]+) ± ([\d.,]+)", panel)
        assert spoken
        estimate, stated = (float(x.replace(",", "")) for x in spoken.groups())
        assert stated == pytest.approx(half, rel=0.06)
        assert estimate == pytest.approx(row["estimate"], abs=0.06 * half)
        t = half / row["robust_error"]
        assert 1.9 < t < 3.0


def test_bars_of_the_forest_plot_are_to_scale(study: tuple[str, Path]) -> None:
    """The leaders' bars are as long, one to another, as their intervals."""
    html, folder = study
    assert LEADERS >= 2
    tables = {
        n: pq.read_table(folder / f"{n}.parameters.parquet").to_pylist() for n in ("best", "plain")
    }
    panels = re.findall(r'<svg [^>]*class="forest".*?</svg>', html, re.DOTALL)
    for i, panel in enumerate(panels):
        root = ET.fromstring(panel)
        bars = [p.get("d") or "" for p in root.iter("path") if p.get("class") == "bar"]
        ends = [tuple(map(float, re.findall(r"[MH](-?[\d.]+)", d))) for d in bars]
        lengths = [b - a for a, b in ends]
        widths = [tables[n][i]["high"] - tables[n][i]["low"] for n in ("best", "plain")]
        assert lengths[0] * widths[1] == pytest.approx(
            lengths[1] * widths[0], abs=0.3 * max(widths)
        )


def test_every_figure_has_an_accessible_name(study: tuple[str, Path]) -> None:
    html, _ = study
    for tag in re.findall(r"<svg [^>]*>", html):
        if 'class="plot"' not in tag:
            assert re.search(r'role="img"', tag)
            assert re.search(r'aria-label="[^"]{5,}"', tag)
    for button in re.findall(r"<button[^>]*>(?=[^<]{1,2}<)", html):
        assert "aria-label=" in button
    figures = re.findall(r"<figure.*?</figure>", html, re.DOTALL)
    assert all("<figcaption>" in figure for figure in figures)


def test_the_residual_stands_below_its_torque_on_a_shared_scale(study: tuple[str, Path]) -> None:
    html, _ = study
    pairs = re.findall(r'class="pair">.*?</div></div>', html, re.DOTALL)
    assert len(pairs) == 4  # two methods, two joints
    scales: dict[str, set[str]] = {}
    for pair in pairs:
        above, below = re.findall(r"<h4>(\S+)", pair)
        assert (above[:3], below) == ("tau", "residual")
        for name, scale in zip(
            (above, f"residual {above}"), re.findall(r'data-y="([^"]*)"', pair), strict=True
        ):
            scales.setdefault(name, set()).add(scale)
    assert [len(found) for found in scales.values()] == [1, 1, 1, 1]


def test_no_two_methods_share_a_colour_however_many_there_are() -> None:
    for side in (0, 1):
        colours = [colours_of(i)[side] for i in range(60)]
        assert len(set(colours)) == 60
    assert rules(60).count("--c:") == 120


@pytest.mark.parametrize(("side", "paper"), [(0, "#ffffff"), (1, "#15171b")])
def test_colours_have_contrast_with_the_page(side: int, paper: str) -> None:
    for pair in PALETTE:
        light, dark = sorted((luminance(pair[side]), luminance(paper)))
        assert (dark + 0.05) / (light + 0.05) >= 3.0
    assert len(DASHES) > 1


def luminance(colour: str) -> float:
    """As WCAG 2 defines it."""
    parts = np.array([int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5)])
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])


def test_a_table_of_parameters_alone_makes_a_page(tmp_path: Path, scarid: Run) -> None:
    columns = {"parameter": SCARA.names, "unit": ["u"] * 8, "estimate": SCARA.apriori}
    path = write(tmp_path / "m.parquet", "parameters", columns)
    html = tmp_path / "r.html"
    assert scarid("report", path, "--html", html).status == 0
    page = page_of(html)
    assert 'class="forest"' in html.read_text("utf-8")
    assert "nan" not in page.text.replace("aria", "")


@pytest.mark.parametrize("at", [1, 2, 3])
def test_each_kind_of_table_alone_makes_a_page(at: int, tmp_path: Path, scarid: Run) -> None:
    html = tmp_path / "r.html"
    assert scarid("report", result_tables(tmp_path)[at], "--html", html).status == 0
    nesting = Nesting()
    nesting.feed(html.read_text("utf-8"))
    assert (nesting.faults, nesting.open) == ([], [])


def test_a_word_is_explained_once(study: tuple[str, Path]) -> None:
    html, _ = study
    words = re.findall(r"<div><dt>([^<]*)</dt>", html)
    assert {"verdict", "95 % interval", "cross", "residual"} <= set(words)
    assert len(words) == len(set(words))
