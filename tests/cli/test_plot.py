"""`scarid plot`: any table as curves or intervals, on a terminal or in a file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pyarrow as pa
import pytest
from conftest import Result, refused
from reports import result_tables, write

from scarid_cli.reporting.shades import DARK

Run = Callable[..., Result]
BRAILLE = {chr(code) for code in range(0x2801, 0x2900)}


def titles(out: str) -> list[str]:
    """The words of the lines above panels, without marks of other curves."""
    lines = [line for line in out.splitlines()[1:-1] if "┤" not in line]
    return [word for line in lines for word in line.split() if word not in "×+o#%"]


@pytest.fixture
def log(samples: Path) -> Path:
    return samples / "scara2.csv"


def test_a_measurement_shows_positions_and_torques_of_each_joint(log: Path, scarid: Run) -> None:
    found = scarid("plot", log)
    assert (found.status, found.err) == (0, "")
    assert found.out.splitlines()[0] == f"{log}: measurement, 501 rows, 0 s to 5 s"
    assert titles(found.out) == ["q1", "q1_ref", "tau1", "q2", "q2_ref", "tau2"]
    assert "t [s]" in found.out.splitlines()[-1]


@pytest.mark.parametrize("width", [30, 60, 80, 200])
def test_a_plot_is_as_wide_as_the_terminal(
    width: int, log: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    lines = scarid("plot", log).out.splitlines()[1:]
    assert width - 12 <= max(map(len, lines)) <= width


@pytest.mark.parametrize("columns", ["0", "1", "x", "9" * 11])
def test_no_width_breaks_a_plot(
    columns: str, log: Path, scarid: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    found = scarid("plot", log)
    assert (found.status, found.err) == (0, "")
    assert 20 <= max(map(len, found.out.splitlines()[1:])) <= 1000


def test_a_pipe_gets_no_colours(log: Path, scarid: Run) -> None:
    out = scarid("plot", log).out
    assert "\033" not in out
    assert set(out) & BRAILLE


def test_the_axis_has_the_extremes_of_the_column(log: Path, scarid: Run) -> None:
    out = scarid("plot", "--columns", "tau1", log).out
    tau = np.genfromtxt(log, delimiter=",", names=True)["tau1"]
    labels = [line.split("┤")[0].strip() for line in out.splitlines() if "┤" in line]
    assert labels[0] == f"{tau.max():.3g}"
    assert labels[-1] == f"{tau.min():.3g}"


def test_a_peak_of_one_row_in_many_is_drawn(tmp_path: Path, scarid: Run) -> None:
    rows = 200_000
    q = np.zeros(rows)
    q[123_456] = 5.0
    path = write(tmp_path / "log.parquet", None, {"t": np.arange(rows) * 0.001, "q1": q})
    top = next(line for line in scarid("plot", path).out.splitlines() if "┤" in line)
    assert top.split("┤")[0].strip() == "5"
    place = [k for k, c in enumerate(top.split("┤")[1]) if c in BRAILLE]
    assert place == [int(123_456 / rows * (80 - 11))]


def test_columns_are_drawn_in_the_order_of_the_wish(log: Path, scarid: Run) -> None:
    assert titles(scarid("plot", "--columns", "tau2, q1*", log).out) == ["tau2", "q1", "q1_ref"]


def test_a_column_that_is_not_there_is_refused(log: Path, scarid: Run) -> None:
    refused(scarid("plot", "--columns", "tau9", log), 65, "column tau9", "patterns such as 'tau*'")


def test_parameters_are_a_forest_in_percent(tmp_path: Path, scarid: Run) -> None:
    columns = {
        "parameter": ["A", "B", "C", "D"],
        "unit": ["kg m2", "N m", "N", "N"],
        "estimate": [2.0, -1.0, 0.0, 3.0],
        "low": pa.array([1.0, -3.0, -1.0, None]),
        "high": pa.array([3.0, 1.0, 1.0, None]),
    }
    path = write(tmp_path / "p.parquet", "parameters", columns)
    lines = scarid("plot", path).out.splitlines()
    bars = {line[0]: line for line in lines[1:5]}
    assert bars["A"].count("─") % 2 == 0
    ends = [bars["A"].index("─"), bars["A"].rindex("─")]
    arrows = [bars["B"].index("◄"), bars["B"].index("►")]
    assert sum(ends) == sum(arrows)  # the same middle
    assert (ends[1] - ends[0]) / (arrows[1] - arrows[0]) == pytest.approx(0.5, abs=0.05)
    assert "◄" in bars["C"]
    assert "unknown" in bars["D"]
    assert bars["A"].split()[:4] == ["A", "2", "kg", "m2"]
    assert "± 1 " in bars["A"]


def test_a_prediction_has_its_residuals(tmp_path: Path, scarid: Run) -> None:
    t = np.arange(100) * 0.01
    columns = {"t": t, "tau1": np.sin(t), "tau1_pred": np.sin(t) - 0.25}
    out = scarid("plot", write(tmp_path / "p.parquet", "prediction", columns)).out
    assert "tau1 - tau1_pred" in out
    assert "0.375" in out  # a constant of 0.25 has half of it as room


@pytest.mark.parametrize("kind", ["metrics", "parameters"])
def test_a_list_without_intervals_is_refused(kind: str, tmp_path: Path, scarid: Run) -> None:
    path = next(p for p in result_tables(tmp_path) if kind in p.name)
    refused(scarid("plot", path), 2, f"a {kind} table has neither times nor intervals")


@pytest.mark.parametrize("kind", ["prediction", "trace"])
def test_a_result_over_time_is_drawn(kind: str, tmp_path: Path, scarid: Run) -> None:
    path = next(p for p in result_tables(tmp_path) if kind in p.name)
    found = scarid("plot", path)
    assert (found.status, found.err) == (0, "")
    assert f": {kind}, " in found.out


def test_unsettled_rows_and_missing_values_are_left_out(tmp_path: Path, scarid: Run) -> None:
    dq = np.array([99.0, 1.0, np.nan, 2.0, 3.0])
    columns = {"t": np.arange(5.0), "q1": dq, "dq1": dq, "ddq1": dq, "settled": [0, 1, 1, 1, 1]}
    out = scarid("plot", write(tmp_path / "m.parquet", "motion", columns)).out
    assert "motion, 4 rows, 1 s to 4 s" in out
    assert "99" not in out.split("\n", 1)[1]


def test_a_sine_is_the_peak_of_its_spectrum(tmp_path: Path, scarid: Run) -> None:
    t = np.arange(4096) / 100.0
    rng = np.random.default_rng(1)
    q = np.sin(2.0 * np.pi * 10.0 * t) + 1e-3 * rng.normal(size=len(t))
    path = write(tmp_path / "log.parquet", None, {"t": t, "q1": q})
    lines = scarid("plot", "--spectrum", path).out.splitlines()
    top = next(line for line in lines if "┤" in line).split("┤")[1]
    low = 100.0 / 2048
    share = np.log(10.0 / low) / np.log(50.0 / low)
    first = next(k for k, c in enumerate(top) if c in BRAILLE)
    assert first == pytest.approx(share * 68, abs=2)
    assert "frequency [Hz]" in lines[-1]


def test_a_spectrum_needs_a_constant_rate(tmp_path: Path, scarid: Run) -> None:
    t = np.cumsum(np.random.default_rng(1).uniform(0.5, 1.5, 100))
    path = write(tmp_path / "log.parquet", None, {"t": t, "q1": t})
    refused(scarid("plot", "--spectrum", path), 65, "column t", "scarid resample")


@pytest.mark.parametrize("words", [[], ["--spectrum"], ["--columns", "tau*"]])
def test_an_svg_knows_the_dark_page(
    words: list[str], log: Path, tmp_path: Path, scarid: Run
) -> None:
    assert scarid("plot", *words, log, "-o", tmp_path / "a.svg").status == 0
    text = (tmp_path / "a.svg").read_text()
    assert ET.fromstring(text).tag.endswith("svg")
    assert "@media (prefers-color-scheme:dark)" in text
    colours = set(re.findall(r"(?:fill|stroke): (#\w+)", text))
    assert colours <= DARK.keys()


def test_a_png_is_one(log: Path, tmp_path: Path, scarid: Run) -> None:
    assert scarid("plot", log, "-o", tmp_path / "a.png").out == ""
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG\r\n")


def test_another_extension_is_refused(log: Path, tmp_path: Path, scarid: Run) -> None:
    refused(scarid("plot", log, "-o", tmp_path / "a.gif"), 2, ".svg or .png")
    assert list(tmp_path.iterdir()) == []


def test_it_ends_a_line_of_stages(log: Path, scarid: Run) -> None:
    out = scarid("differentiate", log, "then", "plot").out
    assert titles(out) == [
        "dq1",
        "dq1_ref",
        "ddq1",
        "ddq1_ref",
        "dq2",
        "dq2_ref",
        "ddq2",
        "ddq2_ref",
    ]
