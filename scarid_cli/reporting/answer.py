"""The first screen of a page: which method is best, by how much, and whether to believe it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from scarid_cli.reporting import dots, forest
from scarid_cli.reporting.kinds import Metrics, Parameters, Result
from scarid_cli.reporting.parts import NONE
from scarid_cli.reporting.standing import Standing, judging, standings
from scarid_cli.reporting.wording import experiment_of, of_kind

KNOWN = re.compile(r"\d+ of \d+ parameters known within [\d.]+ %( \([^)]*\))?")
SAME = 1.05  # times the error of the best: a difference that decides nothing
DOTTED = 12  # methods in the figure at most
NO_VERDICT = "no verdict"


@dataclass(frozen=True)
class Answer:
    """A badge with one sentence, questions with answers, and the figures that show them."""

    badge: str
    sentence: str
    questions: tuple[tuple[str, str], ...]
    caption: str
    figures: tuple[str, ...]


def answer(results: Sequence[Result], colours: dict[str, int]) -> Answer | None:
    """The answer of these results; None if they hold neither estimates nor their quality."""
    order = standings(results)
    if not order:
        return None
    judge = judging(results)
    best = order[0]
    caption, figures = _figures(order, judge, results, colours)
    return Answer(
        badge=best.verdict or NO_VERDICT,
        sentence=_sentence(best),
        questions=tuple(_questions(order, judge)),
        caption=caption,
        figures=tuple(figures),
    )


def _sentence(best: Standing) -> str:
    """Why the best estimates have their verdict."""
    if not best.verdict:
        return (
            f"The estimates of {best.label} come without a verdict of identify; a CSV has none."
            if best.parameters
            else "The tables hold the quality of predictions, but no estimates with a verdict."
        )
    summary = next((m[0] for r in best.reasons if (m := KNOWN.match(r))), "")
    if best.verdict == "good":
        return f"{best.label}: {summary or '; '.join(best.reasons[:1])}."
    return f"{best.label}: {'; '.join(best.reasons[:2])}."


def _questions(order: Sequence[Standing], judge: str) -> list[tuple[str, str]]:
    found = []
    if len(order) > 1:
        found.append(("Which method is best?", _best(order, judge)))
    if len(order) > 1 and isfinite(order[0].error):
        found.append(("By how much?", _margin(order)))
    return [*found, ("May I believe it?", _belief(order))]


def _best(order: Sequence[Standing], judge: str) -> str:
    best = order[0]
    if not best.metrics:
        return f"{best.label}, by its verdict; no quality of predicted torques was given."
    graded = "Of the methods with the best verdict, it" if best.verdict else "It"
    where = f" in the experiment {judge}" if judge else ""
    errors = [f"{dots.error_of(x):.2g} %" if isfinite(x) else NONE for x in best.r2]
    joints = _listed([f"joint {joint}" for joint in best.metrics.joints])
    return (
        f"{best.label}. {graded} predicts the torques{where} with the least errors: "
        f"{_listed(errors)} of the standard deviation of the torque at {joints} "
        f"(R2 {dots.r2_text(best.r2)})."
    )


def _margin(order: Sequence[Standing]) -> str:
    """The next method, and the best of those that are not good."""
    best, others = order[0], [one for one in order[1:] if isfinite(one.error)]
    if not others:
        return "No other method has predictions to compare."
    words = [_compared(others[0], best)]
    worse = next((one for one in others[1:] if one.verdict != best.verdict), None)
    if worse:
        words.append(f"{_compared(worse, best)}, the best of those that are {worse.verdict}")
    return "; ".join(words) + "."


def _compared(other: Standing, best: Standing) -> str:
    ratio = other.error / best.error
    if ratio < 1.0:
        return f"{other.label} has {100 * (1 - ratio):.2g} % smaller errors"
    if ratio < SAME:
        return (
            f"{other.label} is practically equal (its errors are {100 * (ratio - 1):.2g} % larger)"
        )
    if ratio < 2.0:
        return f"the errors of {other.label} are {100 * (ratio - 1):.2g} % larger"
    return f"the errors of {other.label} are {ratio:.2g} times as large"


def _belief(order: Sequence[Standing]) -> str:
    best = order[0]
    trust = {
        "good": "Yes: identify finds no objection.",
        "doubtful": "Only with care: no method has a better verdict than doubtful.",
        "not identifiable": "No: the log does not determine the parameters.",
    }.get(best.verdict, "Unknown: identify the log again, and give its table as Parquet.")
    return " ".join(filter(None, (trust, _hits(best.parameters), _others(order))))


def _hits(parameters: Parameters | None) -> str:
    """How many intervals contain the a priori value, which is the truth of a simulation."""
    if not parameters or not parameters.robot or not parameters.low or not parameters.high:
        return ""
    ends = zip(parameters.low, parameters.robot.apriori, parameters.high, strict=True)
    hits = sum(bool(low <= value <= high) for low, value, high in ends)
    return (
        f"Its 95 % intervals contain the a priori value of {hits} of "
        f"{len(parameters.names)} parameters."
    )


def _others(order: Sequence[Standing]) -> str:
    """The methods that should not be believed."""
    poor = [one.label for one in order[1:] if one.verdict not in ("", "good")]
    if not poor:
        return ""
    names = (
        _listed(poor[:6]) if len(poor) <= 6 else f"{', '.join(poor[:5])} and {len(poor) - 5} more"
    )
    return f"Doubtful or worse: {names}."


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1]))) if words else ""


def _figures(
    order: Sequence[Standing], judge: str, results: Sequence[Result], colours: dict[str, int]
) -> tuple[str, list[str]]:
    """The methods beside each other, or the intervals of the best one alone."""
    if order[0].metrics and (len(order) > 1 or not order[0].parameters):
        joints = order[0].metrics.joints
        rows = [_dots(one, judge, results, colours) for one in order if one.metrics
                and one.metrics.joints == joints][:DOTTED]  # fmt: skip
        hollow = " Hollow: published." if any(row.published for row in rows) else ""
        where = f" in the experiment {judge}" if judge else ""
        caption = (
            f"Errors of the predicted torques{where}, the best method first. The number in a dot "
            f"is that of the joint.{hollow}"
        )
        return caption, [dots.draw(rows, joints, f"{caption} {_spoken(rows)}")]
    estimated = order[0].parameters
    assert estimated is not None  # a method has estimates or metrics
    drawn = [forest.draw(one) for one in forest.forests([estimated], colours)]
    return "The estimates with their 95 % intervals; dashed: a priori.", drawn


def _spoken(rows: Sequence[dots.Dots]) -> str:
    return "; ".join(f"{row.name}: R2 {dots.r2_text(row.r2)}" for row in rows)


def _dots(
    one: Standing, judge: str, results: Sequence[Result], colours: dict[str, int]
) -> dots.Dots:
    metrics = of_kind(results, Metrics)
    printed = (tuple(q.r2 for q in r.qualities) for r in metrics if r.name.published
               and r.name.label == one.label and experiment_of(r) == judge)  # fmt: skip
    return dots.Dots(one.label, colours[one.label], one.verdict, one.r2, next(printed, ()))
