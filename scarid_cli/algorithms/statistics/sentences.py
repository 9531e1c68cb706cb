"""The wording of a verdict: which estimates change, and what the model lacks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.algorithms.statistics.additions import Addition
from scarid_cli.algorithms.statistics.alternatives import (
    ASYMMETRY,
    CABLE,
    CUBE,
    CURVATURE,
    DECAYED,
    DRIFT,
    GAIN,
    GEOMETRY,
    LOAD,
    OFFSET,
    RIPPLE,
    SATURATION,
    SLOW,
    SPRING,
    STRIBECK,
    TILT,
    UNEVEN,
    WAVES,
    tilted,
)
from scarid_cli.algorithms.statistics.curves import laws
from scarid_cli.algorithms.statistics.diagnostics import Diagnostics
from scarid_cli.algorithms.statistics.effects import REVERSALS, Effect, level_among
from scarid_cli.algorithms.statistics.gains import CAUSES
from scarid_cli.algorithms.statistics.mismatches import (
    BACKLASH,
    ELASTIC_GEAR,
    ELASTIC_JOINT,
    HYSTERESIS,
    LATE_POSITION,
    LATE_TORQUE,
    MISMATCHES,
    PRESLIDING,
)
from scarid_cli.algorithms.statistics.parallel import ELASTICITY, ENCODERS, LATE, ZEROS
from scarid_cli.arrays import Array, Marks
from scarid_cli.interval import plus_minus

# The alternatives whose shapes have names of their own.
KINDS = dict.fromkeys(DECAYED, CURVATURE) | {CUBE: CABLE}
KINDS |= {wave: name for name, waves in WAVES.items() for wave in waves}
EACH = 3  # joints, of which each figure has its own label at most
NAMED = 2  # estimates whose change is written out
DECREASES = (
    "friction of {joints} decreases with speed (add Stribeck friction with --estimator separable)"
)
ADVICE = {
    OFFSET: "the torque of {joints} has an offset that the model lacks (add the term offset to the "
    "robot)",
    ASYMMETRY: "friction of {joints} differs between the two directions (add the terms "
    "viscous-forward and viscous-backward to the robot)",
    SLOW: DECREASES,
    STRIBECK: DECREASES,
    CURVATURE: "friction of {joints} is not the sum of Coulomb and viscous friction",
    LOAD: "friction of {joints} grows with the transmitted torque, for which there is no term",
    SPRING: "something pulls on {joints} as a spring or a cable does, for which there is no term",
    CABLE: "something pulls on {joints} more than in proportion to the position, as a bent cable "
    "does, for which there is no term",
    SATURATION: "the logged torque of {joints} is not proportional to the real one, as when a "
    "motor saturates",
    DRIFT: "the torque of {joints} drifts during the log",
    RIPPLE: "the torque of {joints} ripples with the position ({periods}), as of cogging motors or "
    "of gears, for which there is no term",
    UNEVEN: "Coulomb friction of {joints} varies over a turn, as of gears that are not round, for "
    "which there is no term",
    TILT: "gravity acts in another direction than described, as on a tilted base (state gravity = "
    "{gravity} in the TOML file of the robot)",
    ZEROS: "where the log has a position of 0, {zeros} (state it as `zero` in the TOML file of the "
    "robot)",
    ENCODERS: "the position of {joints} has an error that depends on the angle, as of an eccentric "
    "encoder",
    GEOMETRY: "the geometry is not as described: {distances}",
    LATE: "the signals of {joints} are not of the same instant as those of the others",
    ELASTICITY: "the transmission of {joints} is elastic (a gear or a belt between encoder and "
    "link)",
    BACKLASH: "there is a gap in the gear of {joints} (backlash), with the encoder on the motor",
    HYSTERESIS: "the torque of {joints} has a hysteresis, as of its sensor",
    PRESLIDING: "friction of {joints} builds up over a distance behind a reversal (presliding)",
    LATE_POSITION: "the position of {joints} is older than the other signals",
    LATE_TORQUE: "the torque of {joints} is older than the other signals",
    ELASTIC_GEAR: "something yields between encoder and link of {joints} (an elastic gear or belt)",
    ELASTIC_JOINT: "motor and link of {joints} oscillate against each other, the encoder on the "
    "link",
    REVERSALS: "friction near reversals differs from the model (--drop-slow leaves more of the "
    "slow rows out)",
}


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
    elsewhere = _elsewhere(names, diagnostics, OFFSET, {*diagnostics.offsets})
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
        joints = {x.joint for x in own}
        elsewhere = _elsewhere(list(estimates), diagnostics, kind, joints) if kind != TILT else ""
        notes.append(f"{_added(kind, own, estimates, robot)}{elsewhere}")
    return notes


def left_out_of(
    estimates: Mapping[str, float], additions: Sequence[Addition], robot: Robot
) -> list[str]:
    """What a model lacks that has the parameters alone, with what to do about it."""
    gains = {x.joint + 1: 1.0 + x.size for x in additions if x.name == GAIN}
    notes = [
        f"the torque of joint {i} was logged as {factor:.3g} times what the others need ({CAUSES})"
        for i, factor in gains.items()
    ]
    return notes + [_added(kind, own, estimates, robot) for kind, own in _by_kind(additions)]


def _by_kind(additions: Sequence[Addition]) -> list[tuple[str, list[Addition]]]:
    """The additions of each kind, without gains, and offsets where a spring is slack."""
    own = [x for x in additions if x.name not in (OFFSET, GAIN)]
    added = sorted(own, key=lambda x: x.joint)
    kinds = _kinds(added)
    return [
        (kind, [addition for addition, of in zip(added, kinds, strict=True) if of == kind])
        for kind in sorted(set(kinds))
    ]


def _added(kind: str, own: Sequence[Addition], estimates: Mapping[str, float], robot: Robot) -> str:
    """What was fitted of this kind, with the term to add."""
    if kind == TILT:
        return _tilt(own, robot)
    joints = joints_named(dict.fromkeys(x.joint + 1 for x in own))
    advice = ADVICE[kind].format(joints=joints, periods=_periods(_ripples(own), robot))
    if kind == CURVATURE:
        advice = f"{advice}: {laws(own, estimates, robot)}"
    return f"{advice}; {_fitted(kind, own, robot)}"


def _tilt(own: Sequence[Addition], robot: Robot) -> str:
    """The gravity of a base whose tilt was fitted, and by how much it is tilted."""
    assert robot.body
    amounts, errors = np.zeros(2), np.zeros(2)
    for x in own:
        if x.joint < 2:  # the directions; the rest is of the first moments of link 1
            amounts[x.joint], errors[x.joint] = x.size, x.error
    sine = float(np.linalg.norm(amounts))
    error = float(np.degrees(np.linalg.norm(amounts * errors))) / max(sine, 1e-300)
    degrees = f"{np.degrees(np.arcsin(min(sine, 1.0))):.2g} {plus_minus(error)} deg"
    gravity = _vector(tilted(np.array(robot.body.gravity), amounts))
    return f"{ADVICE[TILT].format(gravity=gravity)}; a tilt by {degrees} was fitted as well"


def _kinds(added: Sequence[Addition]) -> list[str]:
    """What each addition belongs to: of a cable the part in proportion to the position as well."""
    cables = {x.joint for x in added if x.name == CUBE}
    return [
        CABLE if x.name == SPRING and x.joint in cables else KINDS.get(x.name, x.name)
        for x in added
    ]


def _elsewhere(names: Sequence[str], diagnostics: Diagnostics, kind: str, joints: set[int]) -> str:
    """`; the interval of my2 allows for the same at joint 2`, or nothing.

    Of this kind `joints` (from 0) have some already.
    """
    level = level_among(diagnostics.effects)
    shared = [
        effect
        for effect in diagnostics.effects
        if effect.shared and KINDS.get(effect.name, effect.name) == kind
    ]
    if not shared or any(effect.significant(level) for effect in shared):  # then it has a note
        return ""
    least = _least(names, diagnostics)
    wide = [any(column) for column in zip(*(np.abs(x.bias) > least for x in shared), strict=True)]
    others = [j + 1 for j in range(len(diagnostics.joints)) if j not in joints]
    if not others or not any(wide):
        return ""
    return f"; {_allowing(names, wide)} the same at {joints_named(others)}"


def _fitted(kind: str, added: Sequence[Addition], robot: Robot) -> str:
    """What was fitted of this kind."""
    if kind == CURVATURE:
        return "a curve over the speed was fitted as well"
    if kind in WAVES:
        return f"fitted as well, with {_amplitudes(added, robot)}"
    if kind == CABLE:
        return f"fitted as well: {_cables(added, robot)}"
    if kind in MISMATCHES:
        return f"fitted as well: {_mismatches(added, robot)}"
    return f"fitted as well: {_sizes(added, robot)}"


def _sizes(added: Sequence[Addition], robot: Robot) -> str:
    """`0.02 and 0.0185 of this torque`, or `0.0993 N m/rad`."""
    units = [_unit(addition.name, robot.joints[addition.joint]) for addition in added]
    sizes = [f"{addition.size:.3g}" for addition in added]
    if len(set(units)) == 1:
        return f"{listed(sizes)} {units[0]}"
    return listed([f"{size} {unit}" for size, unit in zip(sizes, units, strict=True)])


def _mismatches(added: Sequence[Addition], robot: Robot) -> str:
    """`117 +- 4 N m/rad at joint 1 and 98 +- 3 N m/rad at joint 2`."""
    return listed([f"{_mismatch(x, robot.joints[x.joint])} at joint {x.joint + 1}" for x in added])


def _mismatch(x: Addition, joint: Joint) -> str:
    """The delay, stiffness, gap and so on of a mismatch, with half its 95 % interval."""
    if x.name == ELASTIC_GEAR:
        return (
            f"{1.0 / x.size:.3g} {plus_minus(x.error / x.size**2)} {joint.torque_unit}/{joint.unit}"
        )
    if x.name in (BACKLASH, PRESLIDING):
        return f"{2.0 * x.size:.2g} {plus_minus(2.0 * x.error)} {joint.unit}"
    if x.name == HYSTERESIS:
        return f"{x.size:.3g} {plus_minus(x.error)} {joint.torque_unit}"
    if x.name == ELASTIC_JOINT:
        frequency = 0.5 / (np.pi * np.sqrt(x.size))
        return f"{frequency:.3g} {plus_minus(0.5 * frequency * x.error / x.size)} Hz"
    return f"{1e3 * x.size:.3g} {plus_minus(1e3 * x.error)} ms"


def _cables(added: Sequence[Addition], robot: Robot) -> str:
    """`0.02 N m/rad and 0.1 N m/rad3 at joint 1`, and so on."""
    own: dict[int, list[str]] = {}
    for x in sorted(added, key=lambda x: x.name, reverse=True):  # the spring first
        own.setdefault(x.joint, []).append(f"{x.size:.3g} {_unit(x.name, robot.joints[x.joint])}")
    return ", ".join(f"{listed(own[j])} at joint {j + 1}" for j in sorted(own))


Ripple = tuple[int, float]  # the joint (from 0) and the periods per rad or m


def _ripples(added: Sequence[Addition]) -> dict[Ripple, float]:
    """The amplitude of each ripple, from those of its sine and its cosine."""
    found: dict[Ripple, list[float]] = {}
    for x in added:
        found.setdefault((x.joint, x.cycles), []).append(x.size)
    return {ripple: float(np.linalg.norm(sizes)) for ripple, sizes in found.items()}


def _periods(ripples: Iterable[Ripple], robot: Robot) -> str:
    """`10 periods per rad at joint 1, 8 and 16 periods per rad at joint 2`."""
    units = [f"periods per {joint.unit}" for joint in robot.joints]
    return _at_joints(list(ripples), units)


def _amplitudes(added: Sequence[Addition], robot: Robot) -> str:
    """`0.1 N m at joint 1, 0.03 and 0.02 N m at joint 2`."""
    sizes = [(j, size) for (j, _), size in _ripples(added).items()]
    return _at_joints(sizes, [joint.torque_unit for joint in robot.joints])


def _at_joints(values: Sequence[tuple[int, float]], units: Sequence[str]) -> str:
    """Values of joints (from 0), with the units of these."""
    own: dict[int, list[str]] = {}
    for j, value in values:
        own.setdefault(j, []).append(f"{value:.3g}")
    return ", ".join(f"{listed(texts)} {units[j]} at joint {j + 1}" for j, texts in own.items())


def _unit(name: str, joint: Joint) -> str:
    """The unit of the size of an addition to the torque of this joint."""
    torque = joint.torque_unit
    return {
        ASYMMETRY: f"{torque} s/{joint.unit}",
        LOAD: "of this torque",
        SPRING: f"{torque}/{joint.unit}",
        CUBE: f"{torque}/{joint.unit}3",
        SATURATION: f"per {torque}",
        DRIFT: f"{torque}/s",
    }[name]


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
        if effect.name in ADVICE and effect.significant(level) and np.any(_wide(effect, least))
    ]
    if not found:
        return []
    best = max(found, key=lambda effect: effect.clearness(level))
    amounts = _amounts(best, robot, level, diagnostics.cycles)
    advice = ADVICE[best.name].format_map(amounts)
    return [f"{advice}; {_allowing(names, _wide(best, least))} it"]


def _least(names: Sequence[str], diagnostics: Diagnostics) -> Array:
    """The bias of each parameter above which it is worth a word."""
    return np.maximum(diagnostics.scatter[: len(names)], diagnostics.consequences.negligible)


def _allowing(names: Sequence[str], wide: Iterable[bool]) -> str:
    """`the interval of my2 allows for`, of the parameters that are `wide`."""
    found = [name for name, x in zip(names, wide, strict=True) if x]
    intervals, allow = ("interval", "allows") if len(found) == 1 else ("intervals", "allow")
    return f"the {intervals} of {listed(found)} {allow} for"


def _amounts(effect: Effect, robot: Robot, level: float, cycles: Array) -> dict[str, str]:
    """What the advice on an alternative names: its joints, zeros, periods or gravity."""
    if effect.name == TILT and robot.body:
        return {"gravity": _vector(tilted(np.array(robot.body.gravity), effect.amounts[:2]))}
    count = len(robot.joints)
    found = effect.joints(level, count)
    texts = {"joints": joints_named(j + 1 for j in found) if found else ""}
    if effect.name == RIPPLE:
        texts["periods"] = _periods([(j, x) for j in found for x in cycles[:, j] if x], robot)
    if effect.name == GEOMETRY:
        texts["distances"] = listed([_distance(effect, j) for j in found])
    if effect.name == ZEROS:
        texts["zeros"] = listed([f"joint {j + 1} is at {_zero(effect, robot, j)}" for j in found])
    return texts


def _zero(effect: Effect, robot: Robot, joint: int) -> str:
    """`-0.102 +- 0.0018 rad`."""
    error = plus_minus(effect.noise[joint])
    return f"{effect.amounts[joint]:.3g} {error} {robot.joints[joint].unit}"


def _distance(effect: Effect, joint: int) -> str:
    """`the distance from axis 1 to axis 2 is 1 +- 0.1 % larger`."""
    amount, error = 100.0 * effect.amounts[joint], 100.0 * effect.noise[joint]
    size = f"{abs(amount):.2g} {plus_minus(error)} % {'larger' if amount > 0.0 else 'smaller'}"
    return f"the distance from axis {joint} to axis {joint + 1} is {size}"


def _vector(values: Array) -> str:
    """`[0.49, 0, -9.8]`, with what is less than a thousandth of the largest as 0."""
    least = 1e-3 * float(np.max(np.abs(values)))
    return f"[{', '.join(f'{x:.3g}' if abs(x) > least else '0' for x in values.tolist())}]"


def _wide(effect: Effect, least: Array) -> Marks:
    """Which parameters have at `least` such a bias because of this alternative alone."""
    return np.asarray(np.minimum(np.abs(effect.bias), np.abs(effect.apart)) > least)


def percents(parts: Iterable[float]) -> str:
    """Parts of one, as percents with two digits: `0.31, 2.5 %`."""
    return f"{', '.join(_two_digits(100.0 * part) for part in parts)} %"


def of_joints(texts: Sequence[str], unit: str = "") -> str:
    """A list with a text for each joint: `joint 1 0.31 %, joint 2 2.5 %`.

    Of many joints, `joints 1 to 6 0.31, 2.5, ... %`.
    """
    if len(texts) > EACH:
        return f"joints 1 to {len(texts)} {', '.join(texts)}{unit}"
    if len(texts) == 1:
        return f"{texts[0]}{unit}"
    return ", ".join(f"joint {i} {text}{unit}" for i, text in enumerate(texts, start=1))


def percents_of_joints(parts: Iterable[float]) -> str:
    """Parts of one, a number for each joint: `joint 1 0.31 %, joint 2 2.5 %`."""
    return of_joints([_two_digits(100.0 * part) for part in parts], " %")


def _two_digits(x: float) -> str:
    return f"{x:.2g}" if x < 99.5 else f"{x:.0f}"


def joints_named(numbers: Iterable[int]) -> str:
    """`joint 2`, or `joints 1 and 3`: joints by their numbers from 1."""
    names = [str(number) for number in numbers]
    return f"joint{'s' if len(names) > 1 else ''} {listed(names)}"


def listed(names: Sequence[str], most: int = 8) -> str:
    """`a, b and c`; of more than `most` names only the first."""
    shown = list(names[:most])
    if len(names) > most:
        shown.append(f"{len(names) - most} more")
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"
