"""The wording of a verdict: which estimates change, and what the model lacks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from scarid_cli.algorithms.beyond.additions import Addition
from scarid_cli.algorithms.beyond.catalogue import PHENOMENA, kind_of
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.phenomenon import Fitted, Found
from scarid_cli.algorithms.beyond.torques import Cable, Cube, Offset, RelativeGain, Spring
from scarid_cli.algorithms.effects.effects import Effect, level_among
from scarid_cli.algorithms.inference.diagnostics import Diagnostics
from scarid_cli.algorithms.inference.gains import CAUSES
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, Marks
from scarid_cli.words import joints_named, listed

NAMED = 2  # estimates whose change is written out


def changed(names: Sequence[str], estimates: Array, moved: Array, errors: Array, far: Marks) -> str:
    """`ZZ1R would change from 3.42 to 3.1 (12 standard errors)`, of those that move too far.

    Those that move by the most standard errors come first.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        sizes = np.where(far, np.abs(moved) / errors, -1.0)
    order = np.argsort(-sizes)[: int(np.count_nonzero(far))].tolist()
    parts = [
        f"{names[i]} would change from {estimates[i]:.3g} to {estimates[i] + moved[i]:.3g} "
        f"({errors_in(float(sizes[i]))})"
        for i in order[:NAMED]
    ]
    if len(order) > NAMED:
        rest = len(order) - NAMED
        parts.append(f"{rest} more parameter{'s' if rest > 1 else ''} by more than their errors")
    return listed(parts)


def errors_in(size: float) -> str:
    """A number of standard errors in words."""
    return f"{size:.2g} standard errors" if size < 1000.0 else "over 1000 standard errors"


def _offsets(names: Sequence[str], diagnostics: Diagnostics, robot: Robot) -> list[str]:
    found = [
        f"{x:.3g} {robot.joints[j].torque_unit} at joint {j + 1}"
        for j, x in diagnostics.offsets.items()
    ]
    if not found:
        return []
    elsewhere = _elsewhere(names, diagnostics, Offset.NAME, {*diagnostics.offsets})
    return [
        "offsets of the torques, for which the robot has no term, were fitted as well: "
        f"{listed(found)} (add the term offset to the robot){elsewhere}"
    ]


def additions_of(
    estimates: Mapping[str, float], diagnostics: Diagnostics, robot: Robot
) -> list[str]:
    """What was fitted beside the parameters, whose estimates these are, with the terms to add.

    Other joints may have the same: the parameters whose intervals are wider for that are named.
    """
    notes = _offsets(list(estimates), diagnostics, robot)
    for kind, own in _by_kind(diagnostics.additions):
        elsewhere = ""
        if kind != Tilt.NAME:  # which has no joint
            elsewhere = _elsewhere(list(estimates), diagnostics, kind, {x.joint for x in own})
        notes.append(f"{PHENOMENA[kind].added(Fitted(robot, own, estimates))}{elsewhere}")
    return notes


def left_out_of(
    estimates: Mapping[str, float], additions: Sequence[Addition], robot: Robot
) -> list[str]:
    """What a model lacks that has the parameters alone, with what to do about it."""
    gains = {x.joint + 1: 1.0 + x.size for x in additions if x.name == RelativeGain.NAME}
    notes = [
        f"the torque of joint {i} was logged as {factor:.3g} times what the others need ({CAUSES})"
        for i, factor in gains.items()
    ]
    return notes + [
        PHENOMENA[kind].added(Fitted(robot, own, estimates)) for kind, own in _by_kind(additions)
    ]


def _by_kind(additions: Sequence[Addition]) -> list[tuple[str, list[Addition]]]:
    """The additions of each kind, without gains, and offsets where a spring is slack."""
    own = [x for x in additions if x.name not in (Offset.NAME, RelativeGain.NAME)]
    added = sorted(own, key=lambda x: x.joint)
    kinds = _kinds(added)
    return [
        (kind, [addition for addition, of in zip(added, kinds, strict=True) if of == kind])
        for kind in sorted(set(kinds))
    ]


def _kinds(added: Sequence[Addition]) -> list[str]:
    """What each addition belongs to: of a cable the part in proportion to the position as well."""
    cables = {x.joint for x in added if x.name == Cube.NAME}
    return [
        Cable.NAME if x.name == Spring.NAME and x.joint in cables else kind_of(x.name)
        for x in added
    ]


def _elsewhere(names: Sequence[str], diagnostics: Diagnostics, kind: str, joints: set[int]) -> str:
    """`; the interval of my2 allows for the same at joint 2`, or nothing.

    Of this kind `joints` (from 0) have some already.
    """
    level = level_among(diagnostics.effects)
    shared = [
        effect for effect in diagnostics.effects if effect.shared and kind_of(effect.name) == kind
    ]
    if not shared or any(effect.significant(level) for effect in shared):  # then it has a note
        return ""
    least = _least(names, diagnostics)
    wide = [any(column) for column in zip(*(np.abs(x.bias) > least for x in shared), strict=True)]
    others = [j + 1 for j in range(len(diagnostics.joints)) if j not in joints]
    if not others or not any(wide):
        return ""
    return f"; {_allowing(names, wide)} the same at {joints_named(others)}"


def notes_of(names: Sequence[str], diagnostics: Diagnostics, robot: Robot) -> list[str]:
    """What the model lacks most clearly, and the parameters whose intervals are wider for it.

    It is the alternative that noise explains least, not the one that moves the estimates most: many
    move them where one of them is true. With so many alternatives, one is significant by chance
    more often than a single one would be.
    """
    level = level_among(diagnostics.effects)
    least = _least(names, diagnostics)
    found = [
        effect
        for effect in diagnostics.effects
        if PHENOMENA[effect.name].LACKS
        and effect.significant(level)
        and np.any(_wide(effect, least))
        and _possible(effect, effect.joints(level, len(robot.joints)))
    ]
    if not found:
        return []
    best = max(found, key=lambda effect: effect.clearness(level))
    joints = best.joints(level, len(robot.joints))
    there = Found(robot, joints, best.amounts, best.noise, diagnostics.cycles, names)
    advice = PHENOMENA[best.told or best.name].lacks(there)
    return [f"{advice}; {_allowing(names, _wide(best, least))} it"]


def _possible(effect: Effect, joints: Iterable[int]) -> bool:
    """Whether there is such a thing at all of these joints (from 0)."""
    kind = PHENOMENA[effect.name]
    return kind.RANGE is None or all(kind.possible(float(effect.amounts[j])) for j in joints)


def _least(names: Sequence[str], diagnostics: Diagnostics) -> Array:
    """The bias of each parameter above which it is worth a word."""
    return np.maximum(diagnostics.scatter[: len(names)], diagnostics.consequences.negligible)


def _allowing(names: Sequence[str], wide: Iterable[bool]) -> str:
    """`the interval of my2 allows for`, of the parameters that are `wide`."""
    found = [name for name, x in zip(names, wide, strict=True) if x]
    intervals, allow = ("interval", "allows") if len(found) == 1 else ("intervals", "allow")
    return f"the {intervals} of {listed(found)} {allow} for"


def _wide(effect: Effect, least: Array) -> Marks:
    """Which parameters have at `least` such a bias because of this alternative alone."""
    return np.asarray(np.minimum(np.abs(effect.bias), np.abs(effect.apart)) > least)
