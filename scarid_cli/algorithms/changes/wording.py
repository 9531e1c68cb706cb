"""The verdict on a change, in words and for the metadata."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.changes.explanation import Change, Explanation
from scarid_cli.algorithms.changes.hypotheses import (
    DELAY,
    DRIFT,
    LOW_PASS,
    MOTOR,
    PAYLOAD,
    SCALE,
    TILT,
    ZERO,
    Hypothesis,
)
from scarid_cli.arrays import Array
from scarid_cli.interval import plus_minus
from scarid_cli.words import joints_named, percents, percents_of_joints

SHOWN = 4  # amounts that a message names at most
CLEAR = 3.0  # errors: a smaller amount is not named
NOISIER = 2.0  # times the residual at identification

UNCHANGED, CHANGED, UNEXPLAINED = "unchanged", "changed", "unexplained"
LARGER = "larger than at the identification"
DISTURBED = "noise, vibration, friction that the model lacks, or another soft sensor"
# What concerns no single joint, in a few words.
OF_ALL = {
    PAYLOAD: "another payload or set-up",
    DELAY: "another delay",
    SCALE: "scale of all torques",
    TILT: "gravity in another direction, as on a tilted base",
    LOW_PASS: "another low-pass of the torques",
}


@dataclass(frozen=True)
class Verdict:
    """The grade, its reason in words, and everything for the metadata."""

    grade: str
    reason: str
    facts: dict[str, Any]

    @property
    def sentence(self) -> str:
        return f"{self.grade}: {self.reason}"

    @property
    def extra(self) -> dict[str, Any]:
        return {"verdict": self.grade, "reason": self.reason, **self.facts}


def of_wiring(steps: tuple[str, ...]) -> Verdict:
    """The verdict if signals of joints were reversed or swapped."""
    return Verdict(CHANGED, f"reversed or swapped joints: {', '.join(steps)}", {"wiring": [*steps]})


def of_change(
    change: Change,
    values: dict[str, float],
    ratios: Array | None,
    residuals: Array,
    expected: tuple[Array, Array],
    slight: float | None = None,
) -> Verdict:
    """The verdict of the tests.

    `values` are the parameters at identification; `ratios` (joints) the deviations of the residual
    behind all that may have changed, divided by those at identification, if these are known, and
    `residuals` (joints) the rms of the residual, relative to that of the torques. `expected` are
    (joints) those at identification, and what the intervals of the parameters add to them on this
    motion. A change of the torques by this part is `slight`, because it is within the intervals of
    the identification.
    """
    noisy = [] if ratios is None else np.flatnonzero(ratios > NOISIER).tolist()
    noise = "; ".join(f"joint {j + 1} {ratios[j]:.2g} times" for j in noisy if ratios is not None)
    facts = _facts(change, ratios)
    if not change.changed:
        tests = f"{change.tests} tests find no change (smallest p-value {change.p_value:.2g})"
        if ratios is None:
            return Verdict(UNCHANGED, f"{tests}; residual {percents_of_joints(residuals)}", facts)
        if not noise:
            as_stated, reason = _as_stated(residuals, *expected)
            return Verdict(UNCHANGED if as_stated else UNEXPLAINED, f"{reason}; {tests}", facts)
        reason = f"the residuals are {LARGER} ({noise}), but {tests}: {DISTURBED}"
        return Verdict(UNEXPLAINED, reason, facts)
    found = " and ".join(map(_sentence_of(values), change.explanations))
    if slight is not None and not noise:
        size = f"by at most {percents([slight])}, within the intervals of the identification"
        cause = f" (if anything, {found})" if found else ""
        return Verdict(UNCHANGED, f"the torques differ {size}{cause}", facts)
    if change.complete:
        share = f"explains {100.0 * change.explained:.3g} % of the difference"
        more = f"; the residuals without it are {LARGER}, too ({noise}): {DISTURBED}"
        return Verdict(CHANGED, f"{found}; this {share}{more if noise else ''}", facts)
    reason = (
        "differs in a way that no payload, friction, delay, offset, zero or motor constant explains"
    )
    best = f"; most likely {found}, but this explains only {100.0 * change.explained:.2g} %"
    return Verdict(UNEXPLAINED, reason + (best if found else ""), facts)


def _as_stated(residuals: Array, fitted: Array, allowed: Array) -> tuple[bool, str]:
    """Whether the residuals are as large as the identification lets expect, and how large.

    All are relative to the torques (joints): the residuals now and at the identification, nan where
    they are not known, and half the intervals of the torques that the parameters give on this
    motion.
    """
    now = f"residual {percents_of_joints(residuals)}"
    if np.isnan(fitted).any():
        return True, now
    far = np.flatnonzero(residuals > NOISIER * np.hypot(fitted, allowed)).tolist()
    more = np.flatnonzero(residuals > NOISIER * fitted).tolist()
    if far:
        return False, (
            f"the residual of {joints_named(j + 1 for j in far)} is {percents(residuals[far])} of "
            f"the torque, but {percents(fitted[far])} at the identification, to which the "
            f"intervals of the parameters add {percents(allowed[far])}"
        )
    reason = f"{now} ({percents(fitted)} at the identification)"
    if more:
        reason += f", to which the intervals of the parameters add {percents_of_joints(allowed)}"
    return True, reason


def _facts(change: Change, ratios: Array | None) -> dict[str, Any]:
    return {
        "p_value": change.p_value,
        "tests": change.tests,
        "explained": change.explained,
        "explanations": [
            {
                "kind": e.hypothesis.kind,
                "joints": list(e.hypothesis.joints),
                "amounts": dict(zip(e.hypothesis.names, e.amounts, strict=True)),
                "errors": {
                    name: error if np.isfinite(error) else None
                    for name, error in zip(e.hypothesis.names, e.errors, strict=True)
                },
                "rivals": [short(rival) for rival in e.rivals],
            }
            for e in change.explanations
        ],
        "residual_ratios": None if ratios is None else ratios.tolist(),
    }


def short(hypothesis: Hypothesis) -> str:
    """A hypothesis in a few words."""
    joints = hypothesis.joints
    if not joints:
        return OF_ALL[hypothesis.kind]
    which = f"joint {joints[0]}" if len(joints) == 1 else "all joints"
    return f"{hypothesis.kind} of {which}"


def _sentence_of(values: dict[str, float]) -> Any:
    def sentence(e: Explanation) -> str:
        text = f"{short(e.hypothesis)} ({_amounts(e, values)})"
        if not e.rivals:
            return text
        return f"{text}, or {' or '.join(short(rival) for rival in e.rivals)}"

    return sentence


def _amounts(e: Explanation, values: dict[str, float]) -> str:
    """The clearest amounts with their errors."""
    hypothesis = e.hypothesis
    if hypothesis.kind in (MOTOR, SCALE):
        return f"torques {100.0 * e.amounts[0]:+.3g} {plus_minus(100.0 * e.errors[0])} %"
    if hypothesis.kind == DELAY:
        when = "earlier" if e.amounts[0] > 0.0 else "later"
        amount = f"{1e3 * abs(e.amounts[0]):.3g} {plus_minus(1e3 * e.errors[0])} ms"
        return f"torques {amount} {when} than at the identification"
    if hypothesis.kind == LOW_PASS:
        lag, error = 1e3 * abs(e.amounts[0]), 1e3 * e.errors[0]
        return (
            f"torques {'lead' if e.amounts[0] > 0.0 else 'lag'} by {lag:.3g} {plus_minus(error)} ms"
        )
    if hypothesis.kind == TILT:
        known = np.isfinite(e.errors)  # not about an axis about which nothing turns
        amounts, errors = np.array(e.amounts)[known], np.array(e.errors)[known]
        tilt, error = np.degrees((np.linalg.norm(amounts), errors.max(initial=0.0)))
        return f"by {tilt:.2g} {plus_minus(error, 1)} degrees"
    if hypothesis.kind == ZERO:
        size = "large" if e.amounts[0] < 0.0 else "small"
        amount = f"{abs(e.amounts[0]):.3g} {plus_minus(e.errors[0])} {hypothesis.units[0]}"
        return f"its positions are {amount} too {size}"
    if not np.isfinite(e.errors).any():
        return "amounts that the motion does not tell apart"
    clarity = np.abs(e.amounts) / np.maximum(e.errors, 1e-300)
    order = np.argsort(-clarity)
    clear = [int(i) for i in order if clarity[i] > CLEAR] or [int(order[0])]
    texts = [_amount(e, i, values) for i in clear[:SHOWN]]
    return ", ".join(texts) + (", ..." if len(clear) > SHOWN else "")


def _amount(e: Explanation, i: int, values: dict[str, float]) -> str:
    name, unit = e.hypothesis.names[i], e.hypothesis.units[i]
    amount, error, before = e.amounts[i], e.errors[i], values.get(name, 0.0)
    text = f"{name} {amount:+.3g} {plus_minus(error)} {unit}"
    if e.hypothesis.kind == DRIFT and before:
        text += f" ({_rounded(100.0 * amount / before)} %)"
    return text


def _rounded(percent: float) -> str:
    """With a sign and two digits, of which large numbers have more: +9.3, +110."""
    return f"{percent:+.2g}" if abs(percent) < 100.0 else f"{percent:+.0f}"
