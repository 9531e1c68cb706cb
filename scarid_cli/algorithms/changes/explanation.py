"""Which changes explain the difference of two logs, found one after another."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, log

import numpy as np

from scarid_cli.algorithms.changes.evidence import LogEvidence, Products
from scarid_cli.algorithms.changes.hypotheses import LOW_PASS, SEARCHED, Hypothesis, searches
from scarid_cli.algorithms.changes.likelihood import (
    Difference,
    Test,
    everything,
    penalty,
    tested,
)
from scarid_cli.algorithms.uncertainty.tails import log_tail_f
from scarid_cli.arrays import Array

FALSE_ALARMS = 0.01  # of comparisons in which nothing changed, over all tests together
MOST = 3  # changes that are named
WORTH = 0.003  # of the whole difference: a further change that explains less is not named
MOST_RANK = 0.5  # of all directions: several changes that span more would explain anything
LEFT = 0.2  # of the whole difference: if more is left, the changes do not explain it
BENT = (0.75, 1.5)  # of T^2: from halfway between a delay and a low-pass
CLEAR = 3.0  # errors of the delay of a low-pass
SEARCHES = 4  # of all, with the usual columns and with others
CLOSE = 6.0  # twice the logarithm of 20: another change is then 20 times less likely


@dataclass(frozen=True)
class Explanation:
    """A change that explains a part of the difference.

    `amounts` (k) and `errors` (k) are those of the hypothesis, estimated together with all changes.
    `rivals` are hypotheses that explain the difference nearly as well.
    """

    hypothesis: Hypothesis
    amounts: tuple[float, ...]
    errors: tuple[float, ...]
    rivals: tuple[Hypothesis, ...] = ()


@dataclass(frozen=True)
class Change:
    """Whether two logs of a robot differ by more than noise, and what explains it.

    `p_value` is the smallest of all tests, multiplied by their number `tests` (Bonferroni).
    `explained` is the share of the difference that the explanations account for, and `left` the
    p-value of the rest. `whole` is the test of any change of all columns, and `gain` twice the gain
    in log-likelihood by the explanations, less a penalty for their amounts.
    """

    p_value: float
    tests: int
    explanations: tuple[Explanation, ...] = ()
    explained: float = 0.0
    left: float = 0.0
    whole: Test | None = None
    gain: float = 0.0

    @property
    def amounts(self) -> Array:
        """How far all columns changed (columns): as explained, or in whatever way."""
        if not self.complete and self.whole:
            return self.whole.amounts
        parts = [e.hypothesis.directions @ np.array(e.amounts) for e in self.explanations]
        return np.asarray(np.sum(parts, axis=0))

    @property
    def changed(self) -> bool:
        return self.p_value < FALSE_ALARMS

    @property
    def complete(self) -> bool:
        """Whether the explanations account for the difference."""
        enough = self.explained >= 1.0 - LEFT or self.left >= FALSE_ALARMS
        return bool(self.explanations) and enough


def change(first: LogEvidence, sums: Products, possible: list[Hypothesis]) -> Change:
    """Test all hypotheses, and anything else whatever; then look for explanations.

    `sums` are those of the second log. Zeros of the joints, the direction of gravity and a low-pass
    of the torques are taken to be known, unless one of them explains the difference better than all
    else. To leave them open in all tests would hide some changes of motor constants.
    """
    usual = [h for h in possible if h.kind not in SEARCHED]
    found = _change(first.about(()), sums.usual.about(()), usual)
    for kind, places in searches(first.columns):
        more = [h for h in possible if h.kind == kind]
        if not more:
            continue
        second = sums.evidence(places).about(places)
        other = _change(first.about(places), second, [*usual, *more], SEARCHES)
        there = any(_of_search(e) for e in other.explanations if e.hypothesis.kind == kind)
        found = other if there and other.gain > found.gain else found
    return found


def _of_search(explanation: Explanation) -> bool:
    """Whether this is what the search of its own is for.

    Of a delay T the second derivative of the torques has T^2 / 2, of a low-pass twice as much. Of
    noise in the accelerations it has some, too.
    """
    if explanation.hypothesis.kind != LOW_PASS:
        return True
    (delay, bend), (error, _) = explanation.amounts, explanation.errors
    low, high = (share * delay**2 for share in BENT)
    return abs(delay) > CLEAR * error and low < bend < high


def _change(
    first: LogEvidence, second: LogEvidence, possible: list[Hypothesis], of: int = 1
) -> Change:
    """What one `of` so many searches finds.

    A difference that no change with a name explains has to be larger than what the model may lack,
    which another motion shows otherwise. One with a name need not be.
    """
    difference = Difference.between(first, second)
    found = found_in(difference, possible, of)
    if first.biases is None or not found.changed or found.complete:
        return found
    return found_in(difference.allowing(first.biases), possible, of)


def found_in(difference: Difference, possible: list[Hypothesis], of: int = 1) -> Change:
    """What one `of` so many searches finds."""
    whole = everything(difference)
    log_ps = [whole.log_p, *(tested(difference, [h]).log_p for h in possible)]
    log_p = min(min(log_ps) + log(of * len(log_ps)), 0.0)
    if not log_p < log(FALSE_ALARMS):
        return Change(exp(log_p), len(log_ps))
    chosen, rivals = _chosen(difference, possible, whole)
    if not chosen:
        return Change(exp(log_p), len(log_ps), whole=whole)
    found = tested(difference, chosen)
    rest, rank = max(whole.raw - found.raw, 0.0), max(whole.rank - found.rank, 1)
    left = log_tail_f(rest / whole.excess / rank, rank, difference.freedom)
    share = found.beyond_noise / (found.beyond_noise + max(rest - rank * whole.excess, 0.0))
    explanations = _described(chosen, rivals, found)
    gain = found.raw - found.excess * penalty(difference, found.rank)
    return Change(exp(log_p), len(log_ps), explanations, share, exp(left), whole, gain)


def _chosen(
    difference: Difference, possible: list[Hypothesis], whole: Test
) -> tuple[list[Hypothesis], list[tuple[Hypothesis, ...]]]:
    """Hypotheses that explain the difference one after another, each with its rivals."""
    chosen: list[Hypothesis] = []
    rivals: list[tuple[Hypothesis, ...]] = []
    before = Test.nothing()
    while len(chosen) < MOST:
        rest = [h for h in possible if not any(h is c for c in chosen)]
        tests = [tested(difference, [*chosen, h]) for h in rest]
        gains = [t.raw - t.excess * penalty(difference, t.rank) for t in tests]
        best = int(np.argmax(gains))
        if chosen and tests[best].rank > MOST_RANK * whole.rank:
            break
        # That something changed is settled: the first explanation need not pass for all tests
        among = len(possible) + 1 if chosen else 1
        if not _significant(difference, before, tests[best], whole, among):
            break
        chosen.append(rest[best])
        near = [h for h, gain in zip(rest, gains, strict=True) if gain > gains[best] - CLOSE]
        rivals.append(tuple(h for h in near if h is not rest[best]))
        before = tests[best]
    return chosen, rivals


def _significant(
    difference: Difference, before: Test, after: Test, whole: Test, tests: int
) -> bool:
    """Whether one more change explains more than noise does, and a part worth naming."""
    gain, rank = after.raw - before.raw, after.rank - before.rank
    if rank < 1 or (before.rank and gain < WORTH * whole.raw):
        return False
    log_p = log_tail_f(gain / after.excess / rank, rank, difference.freedom)
    return log_p + log(tests) < log(FALSE_ALARMS)


def _described(
    chosen: list[Hypothesis], rivals: list[tuple[Hypothesis, ...]], found: Test
) -> tuple[Explanation, ...]:
    explanations, start = [], 0
    for hypothesis, near in zip(chosen, rivals, strict=True):
        own = slice(start, start + hypothesis.directions.shape[1])
        amounts, own_errors = (tuple(x[own].tolist()) for x in (found.amounts, found.errors))
        explanations.append(Explanation(hypothesis, amounts, own_errors, near))
        start = own.stop
    return tuple(explanations)
