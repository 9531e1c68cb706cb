"""How the torques of the joints fit together: the gain of each, relative to the others.

Joints share parameters: the inertia of a link stands in the rows of all joints before it. So a
torque constant that is wrong for one joint contradicts the rows of the others. What all joints have
in common, and joints that share no parameter with others, no log can tell.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil, log10
from typing import TYPE_CHECKING

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import TORQUES
from scarid_cli.algorithms.beyond.torques import RelativeGain
from scarid_cli.algorithms.effects.effects import CERTAIN, Effect
from scarid_cli.arrays import Array
from scarid_cli.interval import HALF, plus_minus

if TYPE_CHECKING:
    from scarid_cli.algorithms.inference.diagnostics import Diagnostics

KNOWN = 0.05  # error: beyond, a log says less than a data sheet, which knows constants within 10 %
RIVALS = {*TORQUES} - {RelativeGain.NAME}  # other causes of torques that do not fit together
CAUSES = "a torque constant, a gear ratio or a unit is wrong, there or at the others"


@dataclass(frozen=True)
class Gain:
    """The torque of a joint (from 0), divided by what those of the others need; its error."""

    joint: int
    factor: float
    error: float


def fitted(diagnostics: Diagnostics, own: int) -> list[Gain]:
    """The gains that were fitted beside so many own parameters."""
    errors = diagnostics.scatter[own : own + len(diagnostics.additions)]
    return [
        Gain(addition.joint, 1.0 + addition.size, float(error))
        for addition, error in zip(diagnostics.additions, errors, strict=False)
        if addition.name == RelativeGain.NAME
    ]


def estimated(diagnostics: Diagnostics, own: int) -> list[Gain]:
    """The gains that the log tells: those that were fitted, else those of all joints compared."""
    return fitted(diagnostics, own) or known(diagnostics)


def known(diagnostics: Diagnostics) -> list[Gain]:
    """The gains of all joints compared that the log tells, where none were fitted."""
    effect = next((x for x in diagnostics.effects if x.name == RelativeGain.NAME), None)
    return _known(effect) if effect else []


def _known(effect: Effect) -> list[Gain]:
    pairs = enumerate(zip(effect.amounts.tolist(), effect.noise.tolist(), strict=True))
    return [Gain(j, 1.0 + amount, noise) for j, (amount, noise) in pairs if 0.0 < noise < KNOWN]


def significant(diagnostics: Diagnostics) -> list[Gain]:
    """The gains that differ from 1 by more than noise makes them, and were not fitted.

    Where something else of the torques is clearer, such as a base that leans, gains make up for it.
    They are relative to the joints that agree, where these are most.
    """
    likelier = max(
        (x.clearness(CERTAIN) for x in diagnostics.effects if x.name in RIVALS), default=0.0
    )
    for effect in diagnostics.effects:
        if (
            effect.name == RelativeGain.NAME
            and effect.significant()
            and effect.clearness(CERTAIN) > likelier
        ):
            there = np.flatnonzero(effect.ratios > effect.threshold())
            found = [
                Gain(int(j), 1.0 + float(effect.amounts[j]), float(effect.noise[j])) for j in there
            ]
            less = _apart(effect, diagnostics.reference)
            return found if less is None else less
    return []


def relative(effect: Effect, first: int, estimates: Array) -> Effect:
    """The effect of gains that were not fitted, relative to the joints that agree.

    If joint `first` (from 0), beside which gains are, is apart, its own parameters are as much too
    large as its torque, and all others with them. Of two joints nobody knows which one is apart:
    the larger move counts of each parameter. Other effects remain.
    """
    if effect.name != RelativeGain.NAME or not effect.counts:
        return effect
    own = estimates[: len(effect.moved)]
    if len(others := _known(effect)) == 1:
        moved = (own + effect.moved) * others[0].factor - own
        larger = np.abs(moved) > np.abs(effect.moved)
        return replace(effect, moved=np.where(larger, moved, effect.moved))
    less = _apart(effect, first)
    if less is None:
        return effect
    (factor,) = (x.factor for x in less if x.joint == first)
    return replace(effect, moved=(own + effect.moved) / factor - own)


def _apart(effect: Effect, first: int) -> list[Gain] | None:
    """The gains of the joints that are apart, as `apart` has them."""
    return apart([Gain(first, 1.0, 0.0), *_known(effect)], first)


def apart(gains: Sequence[Gain], before: int) -> list[Gain] | None:
    """The gains of the joints that are apart from the most that agree, relative to these.

    None if joint `before` (from 0), beside which they were found, is among those that agree. Two
    gains agree within twice their errors. Of two groups of the same size, the one that agrees
    better counts.
    """
    least = min((x.error for x in gains if x.error > 0.0), default=1.0)
    best: tuple[int, float, list[Gain]] | None = None
    for one in gains:
        away = [abs(x.factor - one.factor) / np.hypot(x.error, one.error or least) for x in gains]
        rest = [x for x, far in zip(gains, away, strict=True) if far > 2.0]
        found = len(rest), sum(far**2 for far in away if far <= 2.0), rest
        if rest and (best is None or found[:2] < best[:2]):
            best = found
    if best is None or all(x.joint != before for x in best[2]):
        return None
    agree = [x for x in gains if x not in best[2]]
    weights = [1.0 / (x.error or least) ** 2 for x in agree]
    common = float(np.average([x.factor for x in agree], weights=weights))
    own = 1.0 / float(np.sqrt(np.sum(weights)))
    errors = [float(np.hypot(x.error, x.factor * own)) / common for x in best[2]]
    pairs = zip(best[2], errors, strict=True)
    return [replace(x, factor=x.factor / common, error=error) for x, error in pairs]


def widening(diagnostics: Diagnostics, own: int) -> tuple[Array, Array] | None:
    """By how much a gain that was not fitted widens the errors (own), and its direction (own).

    It is the same in all logs of a robot, so that it does not count where two are compared.
    """
    effect = next(
        (x for x in diagnostics.effects if x.name == RelativeGain.NAME and x.counts), None
    )
    if effect is None:
        return None
    others = [x.bias**2 for x in diagnostics.effects if x is not effect]
    rest = effect.bias**2 - np.max(others, axis=0, initial=0.0)
    return np.sqrt(np.maximum(rest, 0.0)), effect.direction(diagnostics.scatter[:own])


def _as_known(gain: Gain) -> str:
    """The factor with three digits, or as many as its interval has: 1.0004 beside +- 0.0003."""
    half = HALF * gain.error
    digits = 3 if half > 0.005 else 1 + min(ceil(-log10(max(half, 1e-6))), 6)
    return f"{gain.factor:.{digits}g}"


def told(gains: Sequence[Gain]) -> str:
    """`the torque of joint 2 is 1.37 +- 0.03 times what those of the other joints need: ...`."""
    texts = [
        f"that of joint {gain.joint + 1} is {_as_known(gain)} {plus_minus(gain.error, 1)} times"
        for gain in gains
    ]
    return f"the torques do not fit together: {', '.join(texts)} what the others need ({CAUSES})"
