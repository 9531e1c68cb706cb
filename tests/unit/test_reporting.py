"""The parts of a report: names, reduced curves, what is said, and how it is shown."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scarid_cli.algorithms.robots import reading
from scarid_cli.algorithms.statistics.prediction import Quality
from scarid_cli.reporting import content, figures, text
from scarid_cli.reporting.content import sections
from scarid_cli.reporting.curves import POINTS, Curve
from scarid_cli.reporting.naming import Name, name_of, names_of
from scarid_cli.reporting.parts import Bars, Panels, Section, number, split
from scarid_cli.reporting.results import Metrics, Parameters, Prediction, Trace

SCARA = reading.load("scara2")
NAMES = ("ZZ1R", "Fv1")
UNITS = ("kg m2", "N m s/rad")


def reduced(values: Sequence[float] | np.ndarray, sizes: Sequence[int] = (8192,)) -> np.ndarray:
    """The points of a curve whose samples, a second apart, come in batches of these sizes."""
    curve, x = Curve(), np.asarray(values, dtype=float)
    t, start, turn = np.arange(len(x), dtype=float), 0, 0
    while start < len(x):
        stop = start + sizes[turn % len(sizes)]
        curve.add(t[start:stop], x[start:stop])
        start, turn = stop, turn + 1
    return curve.points()


def a_line(*values: float) -> np.ndarray:
    return np.array([np.arange(len(values), dtype=float), values])


def parameters(
    label: str, *, deviations: tuple[float, ...] = (1.0, 2.0), **more: str
) -> Parameters:
    name = Name(label, more.get("experiment", "direct"))
    return Parameters(name, None, NAMES, UNITS, (3.4, 0.07), deviations, {})


# --- names --------------------------------------------------------------------------------------


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
        ("a\x1b[1m.csv", "trace", "a?[1m", ""),
    ],
)
def test_a_file_name_tells_method_and_experiment(
    file: str, kind: str, label: str, experiment: str
) -> None:
    assert name_of(file, kind) == Name(label, experiment)


def test_equal_labels_are_told_apart_by_folder_then_by_file() -> None:
    files = ["r1/m.csv", "r2/m.csv", "r1/m.trace.csv", "n.csv"]
    kinds = ["parameters", "parameters", "trace", "parameters"]
    labels = [name.label for name in names_of(files, kinds)]
    assert labels == ["r1/m", "r2/m", "r1/m", "n"]
    same = names_of(["m.csv", "m.parquet"], ["trace", "trace"])
    assert [name.label for name in same] == ["m.csv", "m.parquet"]


# --- curves -------------------------------------------------------------------------------------

finite = st.floats(-1e9, 1e9)


@given(st.lists(finite, min_size=1, max_size=POINTS))
def test_a_short_curve_is_kept_as_it_is(values: list[float]) -> None:
    np.testing.assert_array_equal(reduced(values), a_line(*values))


@settings(max_examples=30, deadline=None)
@given(st.integers(1, 40_000), st.lists(st.integers(1, 9000), min_size=1), st.integers(0, 99))
def test_a_reduced_curve_keeps_extremes_order_and_size_however_it_arrives(
    rows: int, sizes: list[int], seed: int
) -> None:
    values = np.cumsum(np.random.default_rng(seed).standard_normal(rows))
    t, x = points = reduced(values)
    assert points.shape[1] <= POINTS + 2
    assert (x.min(), x.max()) == (values.min(), values.max())
    assert (np.diff(t) > 0.0).all()
    np.testing.assert_array_equal(x, values[t.astype(int)])
    np.testing.assert_array_equal(reduced(values, sizes), points)


def test_a_reduced_curve_shows_every_spike_in_equal_parts() -> None:
    values = np.zeros(64_000)
    values[1000::8000] = 5.0
    values[5000::8000] = -5.0
    t, x = reduced(values)
    np.testing.assert_array_equal(t[x > 0.0], np.arange(1000, 64_000, 8000))
    np.testing.assert_array_equal(t[x < 0.0], np.arange(5000, 64_000, 8000))
    assert np.diff(t).max() <= 128  # parts of 64 samples, two points each


# --- what is said -------------------------------------------------------------------------------


@given(st.floats(-1e300, 1e300))
def test_numbers_have_four_significant_digits(value: float) -> None:
    shown = number(value)
    assert len(re.sub(r"e.*|[-.]", "", shown).lstrip("0")) <= 4
    # Below the normal range a double itself has fewer digits.
    assert float(shown) == pytest.approx(value, rel=5.001e-4, abs=1e-300)


def test_what_is_not_a_number_is_a_dash_and_counts_are_whole() -> None:
    values = [float("nan"), float("inf"), None, "text", 123456, 1234.0, -0.0]
    assert [number(v) for v in values] == ["-", "-", "-", "-", "123456", "1234", "0.000"]


def test_parameters_stand_beside_each_other_with_the_a_priori_values_of_their_robot() -> None:
    results = [
        Parameters(
            Name(label, ""), SCARA, tuple(SCARA.names), ("u",) * 8, (1.0,) * 8, (2.0,) * 8, {}
        )
        for label in ("b", "a")
    ]
    (section,) = sections(results)
    assert section.headers == ("parameter", "unit", "a priori", "b", "%", "a", "%")
    assert section.rows[0] == ("ZZ1R", "u", "3.42", "1.000", "2.000", "1.000", "2.000")
    assert [row[0] for row in section.rows] == SCARA.names


def test_other_parameters_go_into_another_section() -> None:
    other = Parameters(Name("c", ""), None, ("M",), ("kg",), (95.0,), (float("nan"),), {})
    found = sections([parameters("a"), other, parameters("b")])
    assert [s.headers for s in found] == [
        ("parameter", "unit", "a", "%", "b", "%"),
        ("parameter", "unit", "c", "%"),
    ]
    assert found[1].rows == (("M", "kg", "95.00", "-"),)
    assert found[1].plots == ()


def test_estimates_of_each_experiment_have_a_section_of_their_own() -> None:
    found = sections([parameters("a"), parameters("a", experiment="cross")])
    assert [section.title for section in found] == ["Parameters: direct", "Parameters: cross"]
    assert {section.headers[-2:] for section in found} == {("a", "%")}


def test_the_bars_are_the_largest_known_deviations() -> None:
    nan = float("nan")
    results = [parameters("a", deviations=(40.0, 2.0)), parameters("b", deviations=(nan, 7.0))]
    (bars,) = sections(results)[0].plots
    assert isinstance(bars, Bars)
    assert (bars.names, bars.values, bars.doubt) == (("a", "b"), (40.0, 7.0), 30.0)


def test_metrics_and_predictions_of_an_experiment_share_a_section() -> None:
    quality = Quality(r2=0.91237, rmse=1.23456, relative_error=21.0, samples=400)
    results = [
        Prediction(Name("a", "cross"), None, (1,), ("N m",), (a_line(1, 2),), (a_line(1, 3),)),
        Metrics(Name("a", "direct"), None, (1,), ("N m",), (quality,)),
        Metrics(Name("a", "cross"), None, (1,), ("N m",), (quality,)),
    ]
    both, cross, direct = sections(results)
    assert (cross.title, direct.title) == ("Torque prediction: cross", "Torque prediction: direct")
    assert both.headers == (
        *("method", "direct tau1 R2", "cross tau1 R2"),
        *("direct tau1 RMSE [N m]", "cross tau1 RMSE [N m]"),
    )
    assert both.rows == (("a", "0.9124", "0.9124", "1.235", "1.235"),)
    assert cross.headers == ("method", "samples", "tau1 R2", "tau1 RMSE [N m]", "tau1 error [%]")
    assert cross.rows == direct.rows == (("a", "400", "0.9124", "1.235", "21.00"),)
    assert (len(cross.plots), len(direct.plots)) == (1, 0)


def test_joints_of_different_units_have_the_unit_in_the_cell() -> None:
    quality = Quality(r2=float("nan"), rmse=2.0, relative_error=1.0, samples=4)
    results = [Metrics(Name(u, ""), None, (1,), (u,), (quality,)) for u in ("N", "N m")]
    (section,) = sections(results)
    assert section.headers[3] == "tau1 RMSE"
    assert [row[2:4] for row in section.rows] == [("-", "2.000 N"), ("-", "2.000 N m")]


def element_of(plot: Any) -> str:
    return figures.element(figures.draw(plot))


def evolution(values: np.ndarray, *, level: bool = True) -> Panels:
    robot = SCARA if level else None
    curves = (a_line(*values),) * 8
    trace = Trace(Name("a", ""), robot, tuple(SCARA.names), ("",) * 8, curves, (0.0,) * 8)
    (plot,) = sections([trace])[0].plots
    assert isinstance(plot, Panels)
    return plot


def test_a_transient_does_not_hide_the_convergence() -> None:
    settled = 3.0 + 0.1 * np.sin(np.arange(200.0))
    transient = np.where(np.arange(200) < 15, 1e4, settled)
    low, high = evolution(transient).panels[0].limits or (0.0, 0.0)
    assert low < min(settled.min(), 3.42) < max(settled.max(), 3.42) < high < 4.0
    assert evolution(settled).panels[0].limits is None


def test_a_constant_trace_and_one_without_robot_are_drawn() -> None:
    plot = evolution(np.ones(5), level=False)
    assert (plot.panels[0].limits, plot.panels[0].level, plot.level) == (None, None, "")
    assert element_of(plot).startswith("<svg")


# --- how it is shown ----------------------------------------------------------------------------

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
    parts = split(section, width, gap=2)
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


def test_a_label_has_one_colour_in_the_whole_report() -> None:
    trace = [
        Trace(Name(x, ""), None, ("p",), ("",), (a_line(1, 2, 3),), (0.0,)) for x in ("b", "a")
    ]
    prediction = Prediction(Name("b", ""), None, (1,), ("",), (a_line(1, 2),), (a_line(1, 3),))
    found = sections([parameters("a"), parameters("b"), *trace, prediction])
    bars, over_time, torques = (p for s in found for p in s.plots)
    assert isinstance(bars, Bars)
    assert isinstance(over_time, Panels)
    assert isinstance(torques, Panels)
    colours = dict(zip(bars.names, bars.colours, strict=True))
    assert {line.name: line.colour for line in over_time.panels[0].lines} == colours
    assert torques.panels[0].lines[1].colour == colours["b"]
    assert figures.colour_of(colours["a"]) in element_of(bars)
    assert len(set(figures.PALETTE)) == len(figures.PALETTE)


def test_many_parameters_are_drawn_in_figures_of_a_page() -> None:
    names = tuple(f"p{i}" for i in range(19))
    trace = Trace(Name("a", ""), None, names, ("",) * 19, (a_line(1, 2),) * 19, (0.0,) * 19)
    plots = sections([trace])[0].plots
    assert [len(p.panels) for p in plots if isinstance(p, Panels)] == [8, 8, 3]
    assert content.PANELS == 8
    assert element_of(plots[-1])


def test_joints_with_different_numbers_of_samples_show_their_range() -> None:
    qualities = tuple(Quality(0.9, 1.0, 1.0, samples=n) for n in (350, 348, 349))
    (section,) = sections([Metrics(Name("m", ""), None, (1, 2, 3), ("N m",) * 3, qualities)])
    assert section.rows[0][1] == "348 to 350"


def test_a_curve_has_no_line_across_a_gap() -> None:
    t = np.concatenate((np.arange(50.0), 90.0 + np.arange(50.0)))
    drawn = figures.broken(np.array([t, np.sin(t)]))
    assert np.flatnonzero(np.isnan(drawn[0])).tolist() == [50]
    np.testing.assert_array_equal(drawn[0][~np.isnan(drawn[0])], t)
