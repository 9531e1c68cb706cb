"""The first screen of repeated experiments: the order of methods, how often, and the quartiles."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import nan

import numpy as np
import pytest

from scarid_cli.algorithms.inference.prediction import Quality
from scarid_cli.reporting.kinds import Metrics, Parameters, Result
from scarid_cli.reporting.naming import Name
from scarid_cli.reporting.study.league import League, Place, drawn
from scarid_cli.reporting.study.opening import others
from scarid_cli.reporting.study.repetitions import opening, ranked

ERRORS = {"kalman": (3.0, 1.0, 2.0, 9.0, 4.0), "2smd": (30.0, 50.0, 40.0, 8.0, 60.0)}


def parameters(label: str, grade: str, error: float = 1.0) -> Parameters:
    extra = {"verdict": grade, "reasons": ["the residual is coloured"]} if grade else {}
    return Parameters(Name(label, ""), None, ("Fs1",), ("N m",), (1.0,), (error,), extra)


def metrics(label: str, errors: Sequence[float], experiment: str = "common") -> Metrics:
    qualities = tuple(Quality(nan, nan, error, 100) for error in errors)
    joints = tuple(range(1, len(errors) + 1))
    return Metrics(Name(label, experiment), None, joints, ("N m",) * len(errors), qualities)


def study(grades: dict[str, Sequence[str]]) -> list[Result]:
    """Two joints, of which the second has twice the error of the first."""
    found: list[Result] = []
    for label, errors in ERRORS.items():
        found += [parameters(label, grade) for grade in grades[label]]
        found += [metrics(label, (error, 2.0 * error)) for error in errors]
        found += [metrics(label, (0.1, 0.1), "direct") for _ in errors]
    return found


def test_the_best_has_the_better_median_verdict_then_the_smaller_median_error() -> None:
    alike = {"kalman": ["good"] * 5, "2smd": ["good"] * 5}
    found = ranked(study(alike))
    assert ([m.label for m in found.methods], found.judge) == (["kalman", "2smd"], "common")
    worse = {**alike, "kalman": ["good", "good", "doubtful", "doubtful", "doubtful"]}
    assert [m.label for m in ranked(study(worse)).methods] == ["2smd", "kalman"]
    rare = {**alike, "kalman": ["doubtful", "good", "good", "doubtful", "good"]}
    assert [m.label for m in ranked(study(rare)).methods] == ["kalman", "2smd"]


def test_the_answers_count_experiments_and_state_medians() -> None:
    rare = {"kalman": ["doubtful", "good", "good", "doubtful", "good"], "2smd": ["doubtful"] * 5}
    found = opening(ranked(study(rare)))
    assert found.grade == "good"
    assert found.headline == (
        "kalman is the best of 2 methods over 5 experiments, and predicts torques best in 4 of them"
    )
    answers = dict(found.answers)
    assert "within joint 1 3 %, joint 2 6 % of their norm; the next, " in answers["How well?"]
    assert "2smd within joint 1 40 %, joint 2 80 %." in answers["How well?"]
    assert "good in 3 of 5 experiments" in answers["May I believe it?"]
    assert "for instance, the residual is coloured" in answers["May I believe it?"]
    assert answers["And the others?"] == "Of all 2: 1 good (kalman), 1 doubtful."
    assert "median and quartiles of 5 experiments" in found.caption


def test_quartiles_are_those_of_each_joint() -> None:
    best = ranked(study({"kalman": ["good"] * 5, "2smd": ["good"] * 5})).methods[0]
    for factor, found in zip((1.0, 2.0), best.quartiles("common"), strict=True):
        assert found == pytest.approx(
            np.percentile(factor * np.array(ERRORS["kalman"]), (25, 50, 75))
        )


def test_parameters_alone_and_torques_alone_have_a_first_screen() -> None:
    estimates = [parameters("a", "good", error) for error in (1.0, 5.0, 2.0)]
    found = opening(ranked(estimates))
    assert found.headline == "The estimates of a in 3 experiments"
    assert dict(found.answers)["How well?"].endswith("known within 2 % at the median.")
    torques = opening(ranked([metrics("a", (4.0,)), metrics("a", (6.0,))]))
    assert torques.grade == ""
    assert dict(torques.answers)["How well?"].endswith("within 5 % of their norm.")
    assert not ranked([]).methods


@pytest.mark.parametrize(
    ("count", "expected"),
    [
        (0, "Best."),
        (1, "Best; the next, a within 1 %."),
        (2, "Best; the next, a within 1 %; the last, b within 2 %."),
        (3, "Best; the next, a within 1 %; the last, c within 3 %."),
    ],
)
def test_the_answer_states_the_next_and_the_last_of_the_others(count: int, expected: str) -> None:
    ranked_others = [("a", (1.0,)), ("b", (2.0,)), ("c", (3.0,))]
    assert others("Best", ranked_others[:count]) == expected


def test_the_axis_of_the_first_figure_names_its_decades() -> None:
    places = (Place("a", "s1", "good", (3.0,)), Place("b", "s2", "good", (70.0,)))
    figure = drawn(League("Errors.", "error", ("joint 1",), places))
    assert re.findall(r">(1|10|100) %</text>", figure) == ["1", "10", "100"]
