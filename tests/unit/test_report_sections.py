"""What a report says: the sections made of results."""

from __future__ import annotations

import re

import numpy as np
import pytest
from reports import SCARA, a_line, element_of, evolution, parameters

from scarid_cli.algorithms.inference.prediction import Quality
from scarid_cli.reporting import figures
from scarid_cli.reporting.content import sections
from scarid_cli.reporting.kinds import Hung, Metrics, Parameters, Prediction, Trace
from scarid_cli.reporting.naming import Name
from scarid_cli.reporting.parts import GAP, PANELS, Bars, Panels, split
from scarid_cli.reporting.study.blocks import Figure
from scarid_cli.reporting.study.estimation import over_time
from scarid_cli.reporting.study.page import PAGE_WIDTH
from scarid_cli.reporting.study.view import View


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


def test_what_may_be_zero_has_its_interval_instead_of_a_percentage() -> None:
    """3673 % of .0001 kg m2 is a standard deviation of .003673 kg m2, of which 1.96 are shown."""
    names, percents = ("ZZ1", "ZZ2"), (3.0, 3673.0)
    one = Parameters(Name("a", ""), None, names, ("kg m2",) * 2, (1.0, -1e-4), percents, {})
    (section,) = sections([one])
    assert [row[3] for row in section.rows] == ["3.000", "+- 0.0072"]
    assert "half the 95 % interval" in section.note


@pytest.mark.parametrize(
    ("possible", "away", "said"),
    [
        (True, 0.0, ""),
        (False, 1.8, "the nearest one is 1.8 standard deviations away."),
        (False, np.inf, "The mass is below 0: less hangs there than on the bare robot."),
    ],
)
def test_a_payload_that_no_body_has_is_said_to_be_none(
    *, possible: bool, away: float, said: str
) -> None:
    nothing = (np.nan,)
    mass = Hung(
        Name("a", ""),
        None,
        "tool0",
        possible,
        away,
        ("m",),
        ("kg",),
        (-1.2,),
        (-1.3,),
        (-1.1,),
        nothing,
    )
    (section,) = sections([mass])
    assert section.note.endswith(said or "one that the motion does not tell.")
    assert " inf " not in section.note


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


@pytest.mark.parametrize("count", [1, 4])
def test_bars_have_as_much_room_above_them_as_below(count: int) -> None:
    names = tuple(f"m{i}" for i in range(count))
    plot = Bars("", "", names, (5.0,) * count, (0,) * count, (False,) * count, 30.0)
    (axes,) = figures._bars(plot).axes
    edges = [y for bar in axes.patches for y in (bar.get_y(), bar.get_y() + bar.get_height())]
    bottom, top = axes.get_ylim()
    assert bottom - max(edges) == pytest.approx(min(edges) - top)
    assert bottom > max(edges)


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
        *("method", "direct: tau1 R2", "cross: tau1 R2"),
        *("direct: tau1 RMSE [N m]", "cross: tau1 RMSE [N m]"),
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


def test_a_transient_does_not_hide_the_convergence() -> None:
    settled = 3.0 + 0.1 * np.sin(np.arange(200.0))
    transient = np.where(np.arange(200) < 15, 1e4, settled)
    low, high = evolution(transient).panels[0].limits or (0.0, 0.0)
    assert low < min(settled.min(), 3.42) < max(settled.max(), 3.42) < high < 4.0
    assert evolution(settled).panels[0].limits is None


def test_running_estimates_are_drawn_at_the_scale_of_those_after_a_tenth_of_the_record() -> None:
    """Whenever the record begins: a transient does not count, and a peak soon after it does."""
    t = 100.0 + np.arange(201.0)
    values = np.where(t < 120.0, 1e4, np.where(t == 121.0, 9.0, 3.0))
    curves = (np.array([t, values]),) * 8
    trace = Trace(Name("a", ""), SCARA, tuple(SCARA.names), ("",) * 8, curves, (0.0,) * 8)
    (chapter,) = over_time(View(None, {"a": 1}), [trace])
    (figure,) = (block for block in chapter.blocks if isinstance(block, Figure))
    low, high = map(float, re.findall(r'data-y="(\S+) (\S+)"', figure.panels[0])[0])
    assert low < 3.0 < 9.0 < high < 10.0


def test_a_constant_trace_and_one_without_robot_are_drawn() -> None:
    plot = evolution(np.ones(5), level=False)
    assert (plot.panels[0].limits, plot.panels[0].level, plot.level) == (None, None, "")
    assert element_of(plot).startswith("<svg")


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
    assert {line.name: line.colour for line in over_time.panels[0].series} == colours
    assert torques.panels[0].series[1].colour == colours["b"]
    assert figures.colour_of(colours["a"]) in element_of(bars)
    assert len(set(figures.PALETTE)) == len(figures.PALETTE)


def test_many_parameters_are_drawn_in_figures_of_a_page() -> None:
    names = tuple(f"p{i}" for i in range(19))
    trace = Trace(Name("a", ""), None, names, ("",) * 19, (a_line(1, 2),) * 19, (0.0,) * 19)
    plots = sections([trace])[0].plots
    assert [len(p.panels) for p in plots if isinstance(p, Panels)] == [8, 8, 3]
    assert PANELS == 8
    assert element_of(plots[-1])


def test_joints_with_different_numbers_of_samples_show_their_range() -> None:
    qualities = tuple(Quality(0.9, 1.0, 1.0, samples=n) for n in (350, 348, 349))
    (section,) = sections([Metrics(Name("m", ""), None, (1, 2, 3), ("N m",) * 3, qualities)])
    assert section.rows[0][1] == "348 to 350"


def test_three_experiments_of_two_joints_fit_the_page_side_by_side() -> None:
    """A group of columns is never divided: headings of one line were wider than the page."""
    quality = Quality(r2=-25.78881, rmse=11.8412, relative_error=107.5, samples=3904)
    results = [
        Metrics(Name("2smd, published", e), None, (1, 2), ("N m",) * 2, (quality,) * 2)
        for e in ("direct", "cross", "common")
    ]
    parts = split(sections(results)[0], PAGE_WIDTH, wrapped=True)
    assert [len(part.headers) for part in parts] == [7, 7]
    for part in parts:
        columns = zip(part.headers, *part.rows, strict=True)
        words = [
            max(max(map(len, re.split(" (?=\\[)|(?<=:) ", c))) for c in column)
            for column in columns
        ]
        assert sum(words) + GAP * (len(words) - 1) <= PAGE_WIDTH
