"""What the words of a report mean, told where each first stands."""

from __future__ import annotations

from collections.abc import Iterable

TERMS = {
    "verdict": "good: the estimates may be used within their intervals, and give each torque "
    "within 10 %. Rough: the same, but some torque is known less well. Doubtful: a reason is "
    "stated why they may be wrong by more than their intervals. Not identifiable: the log does "
    "not determine the parameters.",
    "unchanged": "the log, or the other identification, differs from the identification by no more "
    "than noise, errors of the model and the stated intervals explain. Changed: a cause is found. "
    "Unexplained: it differs, and no cause explains it. Differ: some parameters are apart by more "
    "than their errors.",
    "known within 30 %": "the standard error of a parameter, robust to autocorrelated residuals, "
    "is at most 30 % of its estimate.",
    "model torque within": "half the 95 % interval of the torque that the estimates give on a "
    "motion like that of the log, in percent of the torque. A prediction is also off by the "
    "residual.",
    "95 % interval": "in 95 of 100 experiments an interval calculated in this way contains the "
    "true value, if the model holds. It allows for autocorrelated residuals.",
    "a priori": "the value in the description of the robot; for a simulated robot the true one.",
    "published": "a value printed in an article, for comparison; it was not calculated here.",
    "matched": "positions and torques have passed through filters of the same dynamics, so that "
    "the derivatives and the torque of a row belong to the same instant.",
    "relative error": "norm of the difference between measured and predicted torque, in percent of "
    "the norm of the measured torque.",
    "R2": "the share of the torque's variance that the prediction explains: 1 is perfect, 0 is no "
    "better than the mean.",
    "direct": "the torques of the log from which the parameters were identified.",
    "cross": "the torques of another log, with derivatives from the method's own soft sensor.",
    "common": "the torques of another log, with the same derivatives for all methods (one "
    "zero-phase filtered motion), so that no method looks good because it smooths its own torque.",
    "common motion": "the motion in the table common.EXPERIMENT.motion of the same log, which "
    "stands for the truth where it is not known, as on a real robot. It has errors of its own.",
    "settled": "rows after the start of a soft sensor, when its initial error has died away; only "
    "these are used.",
    "lag share": "the part of a soft sensor's error that a pure delay explains.",
    "soft sensor": "the algorithm that estimates velocity and acceleration from the position.",
    "residual": "predicted minus measured torque, of which noise is a part.",
    "condition number": "how much the least-squares problem amplifies errors; above about 100 some "
    "combination of parameters is weakly determined, unless the columns merely differ in scale.",
}


class Glossary:
    """Hands out each explanation once, where the page first uses the word."""

    def __init__(self) -> None:
        self._told: set[str] = set()

    def explain(self, words: Iterable[str]) -> tuple[tuple[str, str], ...]:
        """The words not explained before, with their meaning, in the order given."""
        new = [w for w in dict.fromkeys(words) if w in TERMS and w not in self._told]
        self._told.update(new)
        return tuple((word, TERMS[word]) for word in new)
