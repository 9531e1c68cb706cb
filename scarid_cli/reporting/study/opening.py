"""The first screen: the verdict, one sentence for each question, and the figure that shows it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from scarid_cli.algorithms.changes.wording import CHANGED, UNEXPLAINED
from scarid_cli.algorithms.inference.verdict import DOUBT, DOUBTFUL, GOOD, GRADES, ROUGH
from scarid_cli.reporting.said import FINE, Said, worst
from scarid_cli.reporting.study import league
from scarid_cli.reporting.study.league import League, Place, joint_percents, percents
from scarid_cli.reporting.study.ranking import Ranking, Standing
from scarid_cli.stages.compare import DIFFER
from scarid_cli.stages.results.documents import half_interval
from scarid_cli.words import listed

ROWS = 12  # of the figure at most
FEW = 2 * ROWS  # parameters: of more, the torques of the joints are shown
VAGUE = 100.0  # percent: an error from which on all are alike
TIE = 1.05  # times the error of the best: as good
NAMED = 4  # good methods that are named at most
EXPERIMENTS = {
    "common": "another log, calculated with one motion for all methods,",
    "cross": "another log",
    "direct": "the log of the identification",
    "": "the log of the validation",
}
BELIEF = {
    GOOD: "Yes, within the stated intervals",
    ROUGH: "Yes, but the intervals are wide",
    DOUBTFUL: "Not without a look at the reason",
}


@dataclass(frozen=True)
class Opening:
    """Grade of the best method ("" if none is known), the answers, and the figure."""

    grade: str
    headline: str
    answers: tuple[tuple[str, str], ...]
    caption: str
    figure: Markup

    @classmethod
    def of(
        cls, grade: str, headline: str, answers: Sequence[tuple[str, str]], figure: League
    ) -> Opening:
        """With the answers that are not empty, and the figure drawn."""
        given = tuple((question, answer) for question, answer in answers if answer)
        return cls(grade, headline, given, figure.caption, league.drawn(figure))


def opening(ranking: Ranking, colours: dict[str, int], said: Sequence[Said] = ()) -> Opening:
    """What a reader who has not seen the study needs to know of it.

    `said` is what validate and compare have said; of the validations, those of the best count.
    """
    best = ranking.best
    rivals = [s for s in ranking.standings[1:] if s.parameters]
    others_said = {one for s in rivals for one in s.said}
    own = [one for one in said if one not in others_said]
    alarm = worst(own)
    answers = [
        ("How well?", _how_well(ranking)),
        ("May I believe it?", _belief(ranking, alarm)),
        ("Has the robot changed?", _changed(own, alarm)),
    ]
    if rivals:
        grades = [(standing.name, standing.grade) for standing in ranking.identified]
        answers.append(("And the others?", counted(grades)))
    grade = alarm.verdict if alarm and best.grade in (GOOD, ROUGH, "") else best.grade
    if alarm and alarm.verdict != UNEXPLAINED:
        grade = alarm.verdict
    return Opening.of(grade, _headline(ranking, alarm), answers, _figure(ranking, colours))


def _changed(said: Sequence[Said], alarm: Said | None) -> str:
    """What validate and compare have said: the worst, and how many others are fine."""
    if not said:
        return ""
    fine = sum(one.verdict in FINE for one in said)
    if alarm:
        more = f" ({fine} of {len(said)} are unchanged.)" if fine else ""
        start = "Perhaps" if alarm.verdict == UNEXPLAINED else "Yes"
        return f"{start}. {alarm.title}: {alarm.reason}.{more}"
    if len(said) > 1:
        return f"No: none of the {fine} logs and tables differs from the identification."
    return f"No. {said[0].title}: {said[0].reason}."


def _headline(ranking: Ranking, alarm: Said | None) -> str:
    if alarm and alarm.verdict == CHANGED:
        return f"The robot of {alarm.what} has changed"
    if alarm and alarm.verdict == DIFFER:
        return f"{alarm.what} and {alarm.against} differ by more than their errors"
    best, count = ranking.best.name, len(ranking.identified)
    if count == 1:
        grade = ranking.best.grade
        return f"The estimates of {best} are {grade}" if grade else f"The estimates of {best}"
    return f"{best} is the best of {count} identifications"


def _how_well(ranking: Ranking) -> str:
    """By how much the best is better than the next and than the last."""
    judge, ranked = ranking.judge, list(ranking.standings)
    if judge is None or not ranking.best.errors(judge):
        known = _known(ranking.best)
        return f"The parameters are known within {known} % at the median." if known else ""
    known_ones = [s for s in ranked if s.errors(judge)]
    text = (
        f"It predicts the torques of {EXPERIMENTS.get(judge, f'the experiment {judge}')} within "
        f"{joint_percents(known_ones[0].errors(judge))} of their norm"
    )
    tied = [s for s in known_ones[1:] if s.score(judge) <= TIE * known_ones[0].score(judge)]
    if tied:
        text += f", as does {listed([s.label for s in tied])}"
    rest = [s for s in known_ones[1:] if s not in tied]
    return others(text, [(s.label, s.errors(judge)) for s in rest])


def others(text: str, ranked: Sequence[tuple[str, Sequence[float]]]) -> str:
    """The sentence, with the errors [%] of the next and of the last of these methods."""
    chosen = [*ranked[:1], *ranked[1:][-1:]]
    tails = [f"{label} within {joint_percents(errors)}" for label, errors in chosen]
    names = ("the next, ", "the last, ")
    rest = "; ".join(a + b for a, b in zip(names, tails, strict=False))
    return f"{text}; {rest}." if rest else f"{text}."


def _known(best: Standing) -> str:
    return percents([best.vagueness()])


def _belief(ranking: Ranking, alarm: Said | None) -> str:
    """The answer from the verdicts of identify, validate and compare together."""
    best = ranking.best
    if not best.grade:
        if alarm:
            return f"Not for {alarm.what}: it is {alarm.verdict}."
        return "The tables state no verdict of identify; a CSV file cannot carry one."
    reasons = "; ".join(best.reasons[:1])
    belief = BELIEF.get(best.grade, "No: the log does not determine the parameters")
    why = f": {reasons}" if reasons else ""
    if not alarm:
        return f"{belief}{why}."
    if any(alarm in s.said for s in ranking.standings if not s.parameters):
        return (
            f"{belief}{why}, for the robot as it was when it was identified. {alarm.what} is "
            f"{alarm.verdict}."
        )
    if best.grade in (GOOD, ROUGH):
        return (
            f"For the robot as it was identified, within the stated intervals{why}. Not for "
            f"{alarm.what}, which is {alarm.verdict}."
        )
    return f"{belief}{why}; and {alarm.what} is {alarm.verdict}."


def counted(methods: Sequence[tuple[str, str]]) -> str:
    """How many methods have which verdict, from their names and verdicts; "" if none is known."""
    counts = Counter(grade for _, grade in methods)
    good = [name for name, grade in methods if grade == GOOD]
    named = f" ({', '.join(good)})" if 0 < len(good) <= NAMED else ""
    found = [
        f"{counts[grade]} {grade}{named if grade == GOOD else ''}"
        for grade in GRADES
        if counts[grade]
    ]
    return f"Of all {len(methods)}: {', '.join(found)}." if found else ""


def _figure(ranking: Ranking, colours: dict[str, int]) -> League:
    """Torque errors of the methods, or, where there are none, the errors of the parameters."""
    judge = ranking.judge
    if judge is None or (len(ranking.identified) == 1 and ranking.best.parameters):
        return _of_parameters(ranking, colours)
    ranked = [s for s in ranking.standings if s.errors(judge)][:ROWS]
    joints = next(iter(ranked)).metrics[judge].joints
    places = (Place(s.name, f"m{colours[s.label]}", s.grade, s.errors(judge)) for s in ranked)
    where = EXPERIMENTS.get(judge, f"the experiment {judge}")
    return League(
        caption=f"Error of the predicted torques of {where.rstrip(',')}; the best method first, "
        "further left is better.",
        axis="relative error of the predicted torque [%]",
        marks=tuple(f"joint {joint}" for joint in joints),
        places=tuple(places),
    )


def _of_parameters(ranking: Ranking, colours: dict[str, int]) -> League:
    """Errors of each parameter of the best, or the median of each method."""
    best = ranking.best.parameters
    if best is None or len(ranking.identified) > 1:
        places = tuple(
            Place(s.name, f"m{colours[s.label]}", s.grade, (s.vagueness(),))
            for s in ranking.standings[:ROWS]
        )
        caption = "Median relative standard error of the parameters of each method."
    else:
        errors, style = best.robust or best.deviations, f"m{colours[ranking.best.label]}"
        if len(errors) > FEW and (figure := _of_torques(best.extra, style)):
            return figure
        pairs = zip(best.names, errors, strict=True)
        places = tuple(Place(name, style, "", (error,)) for name, error in pairs)
        caption = "Relative standard error of each parameter; half the interval is twice as much."
    return League(
        caption=f"{caption} The line marks {DOUBT:g} %, above which a parameter is not known; "
        "further left is better.",
        axis="relative standard error [%]",
        marks=("error",),
        places=places,
        limit=DOUBT,
        most=VAGUE,
    )


def _of_torques(extra: dict[str, Any], style: str) -> League | None:
    """How well the torques of each joint are known; None if the metadata do not say it."""
    places = []
    for number, joint in enumerate(extra.get("joints", ()), start=1):
        half, needed = half_interval(joint.get("torque_error"), extra), joint.get("needed")
        if half is None or needed is None:
            return None
        values = (100.0 * half, 100.0 * needed, joint["relative_error"])
        places.append(Place(f"joint {number}", style, "", values))
    return League(
        caption="Half the 95 % interval of the torque that the estimates give on a motion like "
        "that of the log (model torque) and that the robot needs on another one (needed torque), "
        "and what they leave of the log (residual), in percent of the torque; further left is "
        "better.",
        axis="percent of the torque",
        marks=("model torque", "needed torque", "residual"),
        places=tuple(places),
    )
