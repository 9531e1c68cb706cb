"""The verdict on an estimation: a grade, and its reasons in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from scarid_cli.algorithms.beyond.model import transmitted
from scarid_cli.algorithms.beyond.positions import OwnDelays
from scarid_cli.algorithms.beyond.rows import Parallel
from scarid_cli.algorithms.effects.effects import Effect
from scarid_cli.algorithms.inference import gains
from scarid_cli.algorithms.inference.diagnostics import Diagnostics
from scarid_cli.algorithms.inference.sentences import (
    additions_of,
    changed,
    errors_in,
    notes_of,
)
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.cuts import Cut
from scarid_cli.algorithms.uncertainty.residuals import JointResidual
from scarid_cli.arrays import Array, Marks
from scarid_cli.words import joints_named, listed, of_joints, percents, percents_of_joints

if TYPE_CHECKING:  # cvxpy takes a second to import
    from scarid_cli.algorithms.robots.possible import Possible

GOOD, ROUGH, DOUBTFUL, NOT_IDENTIFIABLE = "good", "rough", "doubtful", "not identifiable"
GRADES = (GOOD, ROUGH, DOUBTFUL, NOT_IDENTIFIABLE)  # from the best
DOUBT = 30.0  # %: half the width of the interval above which a parameter counts as unknown
WEAK = 1e4  # scaled condition number above which a combination of parameters is undetermined
POOR = 0.8  # R2 below which the model does not explain the torque of a joint
DEVIATIONS = 3.0  # standard errors by which an estimate may move
PART = 0.01  # of an estimate, by which it may move however small its error is
NOISE = 3.0  # times the torque noise: a joint with a smaller torque counts as not driven
BLOCKS = 5.0  # effective blocks, below which errors cannot be stated
HELD_OUT = 1.5  # times the residual of the fit that the one of held-out parts may reach
# Of the torque, half its interval: what `validate` takes for a slight change, so that a good model
# is one beside which a change that matters is seen; noise alone must not make more.
VAGUE = 0.1
UNKNOWN = 0.3  # the same, with all alternatives allowed for: beyond it a torque is not known
UNMATCHED = " (if the motion was not matched, use scarid differentiate --match)"
CAUSE = "`scarid check LOG` looks for the cause (units, signs, order of joints)"
BODIES = ", or --consistent for the nearest estimates that are possible"
LASTING = 0.2  # s: what friction makes that the model lacks at a reversal is shorter
FEW = 3  # unknown parameters that are named


@dataclass(frozen=True)
class Verdict:
    """The grade and its reasons, each a clause without its full stop.

    `biased` tells whether the log failed a check, an alternative to the signals moves the estimates
    too far, or none could be tried.
    """

    grade: str
    reasons: tuple[str, ...]
    biased: bool


# What --require can ask for, from the least to the most.
IDENTIFIABLE, NOT_BIASED = "identifiable", "not-biased"
REQUIREMENTS = (GOOD, ROUGH, NOT_BIASED, IDENTIFIABLE)


def meets(required: str, grade: str, *, biased: bool) -> bool:
    """Whether a verdict is as good as one of REQUIREMENTS."""
    if required in GRADES:
        return GRADES.index(grade) <= GRADES.index(required)
    return grade != NOT_IDENTIFIABLE and not (required == NOT_BIASED and biased)


@dataclass(frozen=True)
class Evidence:
    """What a verdict is based on; `estimates` and errors are in the order of `names`.

    The verdict does not recommend the options of the `treatment` that are already in use, nor a
    `matched` motion if this one is known to be so. `unexplained` says at which times the torques
    are not explained, if they are few, and `failed` which checks the log did not pass. `bodies` are
    given if the estimates are those of rigid bodies.
    """

    names: Sequence[str]
    estimates: Array
    condition: float
    scaled_condition: float
    weak: str
    diagnostics: Diagnostics
    treatment: Treatment
    matched: bool = False
    unexplained: str = ""
    failed: Sequence[str] = ()
    bodies: Possible | None = None


def verdict(evidence: Evidence, robot: Robot) -> Verdict:
    """Grade an estimation, with the gravest reasons first."""
    joints = evidence.diagnostics.joints
    summary = _summary(evidence)
    obstacles = [*_idle(joints, robot), *_undetermined(evidence)]
    apart = gains.significant(evidence.diagnostics)
    found = gains.fitted(evidence.diagnostics, len(evidence.names)) or _far(apart, evidence)
    bias = [*evidence.failed, *([gains.told(found)] if found else []), *_biased(evidence)]
    if obstacles:
        return Verdict(NOT_IDENTIFIABLE, (*obstacles, *evidence.failed, summary), bool(bias))
    wrong = [
        *bias,
        *_forgotten(evidence.diagnostics),
        *_changed(evidence, robot),
        *_poor(joints),
        *_vague(evidence),
        *_impossible(evidence, robot),
    ]
    if wrong and evidence.unexplained and not evidence.failed:
        wrong = [evidence.unexplained, *wrong]
    names, diagnostics = evidence.names, evidence.diagnostics
    own = dict(zip(names, evidence.estimates.tolist(), strict=False))
    notes = [*additions_of(own, diagnostics, robot), *notes_of(names, diagnostics, robot)]
    if apart and found is not apart:
        notes = [f"{gains.told(apart)}; the intervals allow for it", *notes]
    notes = [*_inertia_unknown(evidence), *notes]
    if not wrong and any(x.end - x.start >= LASTING for x in evidence.diagnostics.bursts):
        notes = [*([evidence.unexplained] if evidence.unexplained else []), *notes]
    rough = [] if wrong else _rough(evidence)
    grade = DOUBTFUL if wrong else ROUGH if rough else GOOD
    return Verdict(grade, (*wrong, *rough, summary, *notes), bool(bias))


def _far(apart: list[gains.Gain], evidence: Evidence) -> list[gains.Gain]:
    """Gains that were not fitted, if one is farther from 1 than the stated torque of its joint."""
    stated = np.maximum(evidence.diagnostics.lacking, gains.KNOWN)
    return apart if any(abs(x.factor - 1.0) > stated[x.joint] for x in apart) else []


def _rough(evidence: Evidence) -> list[str]:
    """Why estimates that are right within their intervals are of little use: these are wide."""
    torque = evidence.diagnostics.width * evidence.diagnostics.consequences.torque
    reasons = [
        f"the torque of joint {i} is known within {percents([x])} only"
        for i, x in enumerate(torque, start=1)
        if x > VAGUE
    ]
    if reasons:
        return [*reasons, "take a longer log, or one that moves more"]
    return [
        f"the torque that joint {i} needs on other motions is known within {percents([x])} only, "
        "because the model lacks something"
        for i, x in enumerate(evidence.diagnostics.lacking, start=1)
        if x > VAGUE
    ]


def _idle(joints: Sequence[JointResidual], robot: Robot) -> list[str]:
    """Joints with hardly any torque, which parameters of zero would fit as well."""
    return [
        f"joint {i} has hardly any torque ({joint.torque:.3g} {robot.joints[i - 1].torque_unit} "
        "rms, less than its noise or Coulomb friction), so parameters of zero would fit it: use a "
        "log in which it is driven"
        for i, joint in enumerate(joints, start=1)
        if joint.torque
        < max(NOISE * robot.joints[i - 1].torque_noise, abs(robot.value("coulomb", i)))
    ]


def _undetermined(evidence: Evidence) -> list[str]:
    if not evidence.scaled_condition > WEAK:
        return []
    return [
        f"the motion hardly determines {evidence.weak} (scaled condition number "
        f"{evidence.scaled_condition:.2g}): use one that excites it, or fewer parameters"
    ]


def _forgotten(diagnostics: Diagnostics) -> list[str]:
    if diagnostics.blocks >= BLOCKS:
        return []
    return [
        f"only {diagnostics.blocks:.1f} independent parts of the log count, too few to state "
        "errors: use a longer log, or a --forgetting nearer to 1"
    ]


def _biased(evidence: Evidence) -> list[str]:
    """Alternatives to the signals that would move the estimates by more than their errors."""
    found = {effect.name: effect for effect in evidence.diagnostics.effects}
    if Parallel.NAME not in found:
        return [
            "the estimates were not tested for bias, because no part of the log without a gap or a "
            "row left out is long enough: use a longer log"
        ]
    reasons = []
    if moved := _moved(evidence, found[Parallel.NAME]):
        reasons.append(
            "the estimates depend on the soft sensor: with the same low-pass for derivatives and "
            f"torques, {moved}{'' if evidence.matched else UNMATCHED}"
        )
    if OwnDelays.NAME in found and (moved := _moved(evidence, found[OwnDelays.NAME])):
        advice = "" if evidence.treatment.align else "; --align fits a delay"
        reasons.append(
            "torque and motion are not those of one instant, or a joint is flexible: with a delay "
            f"and the second derivative of the torque fitted as well, {moved}{advice}"
        )
    return reasons


def _moved(evidence: Evidence, effect: Effect) -> str:
    """Which estimates an effect moves too far; empty if there are none."""
    scatter = evidence.diagnostics.scatter[: len(evidence.estimates)]
    far = np.abs(effect.apart) > np.maximum(DEVIATIONS * scatter, _allowed(evidence))
    if not effect.significant() or not far.any():
        return ""
    return changed(evidence.names, evidence.estimates, effect.apart, scatter, far)


def _allowed(evidence: Evidence) -> Array:
    """By how much estimates may move however small their errors are (parameters).

    Of a log without noise, the errors of parameters that are 0 are as small as rounding.
    """
    negligible = evidence.diagnostics.consequences.negligible
    return np.maximum(PART * np.abs(evidence.estimates), negligible)


def _changed(evidence: Evidence, robot: Robot) -> list[str]:
    """Parameters of the links that changed during the log; friction may warm up."""
    friction = {p.name for p in robot.parameters if not transmitted(p.term)}
    links = np.array([name not in friction for name in evidence.names])
    cuts = evidence.diagnostics.cuts
    found = [(*_farthest(evidence, cut, links), time, cut) for time, cut in cuts]
    if not found:
        return []
    errors, worst, time, cut = max(found, key=lambda x: x[0])
    if not errors:
        return []
    return [
        f"the log is not of one robot: {evidence.names[worst]} is {cut.before[worst]:.3g} up to "
        f"about {time:.3g} s after its start, and {cut.after[worst]:.3g} from then on "
        f"({errors_in(errors)}): did the payload change?"
    ]


def _farthest(evidence: Evidence, cut: Cut, links: Marks) -> tuple[float, int]:
    """By how many errors the estimate moves most that differs, and which it is; 0 if none does."""
    moved = np.abs(cut.after - cut.before)
    far = cut.differ(links) & (0.5 * moved > _allowed(evidence))
    with np.errstate(divide="ignore", invalid="ignore"):
        sizes = np.where(far, moved / cut.errors, 0.0)
    worst = int(np.argmax(sizes))
    return float(sizes[worst]), worst


def _vague(evidence: Evidence) -> list[str]:
    """Joints whose torque is not known, or not predicted within its noise."""
    found, width = evidence.diagnostics.consequences, evidence.diagnostics.width
    intervals = zip(width * found.noise, width * found.torque, strict=True)
    reasons = [
        _vague_torque(i, float(np.max([noise, whole])))
        for i, (noise, whole) in enumerate(intervals, start=1)
        if not (noise <= VAGUE and whole <= UNKNOWN)
    ]
    reasons += _unpredicted(evidence)
    explained = not _poor(evidence.diagnostics.joints) and not evidence.unexplained
    if not reasons or evidence.treatment.essential or not explained:
        return reasons
    return [*reasons, "try --essential, which leaves out the parameters that are not known"]


def _vague_torque(joint: int, within: float) -> str:
    """What is said of a torque that is known `within` this part of itself, which may be nan."""
    if not np.isfinite(within):
        return f"the uncertainty of the torque of joint {joint} is not known"
    if within > 1.0:
        return f"the torque of joint {joint} is not known: its interval is wider than the torque"
    return f"the torque of joint {joint} is known only within {percents([within])}"


def _unpredicted(evidence: Evidence) -> list[str]:
    """Joints whose torque is not known where the parameters were not fitted.

    The error of held-out parts must be far beyond that of the fit, by as much of the torque as an
    interval may have: with good sensors, hardly any error may still be several times that of a fit.
    """
    ratios, joints = evidence.diagnostics.consequences.held_out, evidence.diagnostics.joints
    fitted = np.array([0.01 * joint.relative_error for joint in joints])
    if not np.all(fitted * ratios <= 1.0):  # an error as large as the torque
        return [
            "some part of the motion occurs only once, and without it the parameters are not "
            "determined: use a log that repeats it"
        ]
    beyond = fitted * np.sqrt(np.maximum(ratios**2 - 1.0, 0.0))
    advice = "" if evidence.unexplained else ": use a longer log, or fewer parameters"
    return [
        f"parts of the log that were left out of the fit are predicted with an error of "
        f"{percents([fit * ratio])} of the torque of joint {i}, those of the fit with "
        f"{percents([fit])}{advice}"
        for i, (fit, ratio, more) in enumerate(zip(fitted, ratios, beyond, strict=True), start=1)
        if ratio > HELD_OUT and 2.0 * more > VAGUE
    ]


def _inertia_unknown(evidence: Evidence) -> list[str]:
    """A note on joints whose inertia may be zero: friction or gravity makes their torque."""
    within = evidence.diagnostics.width * evidence.diagnostics.consequences.inertia
    unknown = [i for i, part in enumerate(within, start=1) if part > 1.0]
    if not unknown:
        return []
    return [
        f"the inertia of {joints_named(unknown)} is not known: do not predict the torques of "
        "faster motions"
    ]


def _poor(joints: Sequence[JointResidual]) -> list[str]:
    """Joints whose torque is not explained; the last one is followed by what to do."""
    reasons = [
        f"joint {i} has no R2, because its torque is constant or fewer than two of its rows count"
        if np.isnan(joint.r2)
        else f"the model does not explain the torque of joint {i} (R2 {joint.r2:.3g})"
        for i, joint in enumerate(joints, start=1)
        if not joint.r2 >= POOR
    ]
    return [*reasons[:-1], f"{reasons[-1]}: {CAUSE}"] if reasons else []


def _impossible(evidence: Evidence, robot: Robot) -> list[str]:
    """Friction parameters that are significantly negative, and inertias that are negative at all.

    Such friction would drive the robot, and no controller or simulator can use such an inertia.
    """
    if evidence.bodies:
        return _no_bodies(evidence, evidence.bodies)
    inertias = _inertia_negative(evidence)
    rows = _friction_known(evidence, robot)
    negative = [row for row in rows if row[2] < 0.0]
    if 1 < len(negative) == len(rows):
        return ["all friction that is known is negative: the torques' sign seems reversed"]
    driven = {j for j, _, x in rows if x < 0.0} - {j for j, _, x in rows if x > 0.0}
    backwards = [j for j in inertias if (j,) in driven]
    reasons = [
        f"the friction parameter {name} is negative ({x:.3g})"
        for of, name, x in negative
        if not set(of) <= set(backwards)
    ]
    if backwards:
        reasons.append(
            f"friction and inertia of {joints_named(backwards)} are negative: the torque's sign "
            "seems reversed"
        )
    if rest := [j for j in inertias if j not in backwards]:
        values = ", ".join(f"{inertias[j]:.2g}" for j in rest)
        reasons.append(
            f"the inertia of {joints_named(rest)} is negative ({values}), which is impossible: use "
            f"a log with larger accelerations{BODIES if robot.body else ''}"
        )
    return reasons


def _no_bodies(evidence: Evidence, found: Possible) -> list[str]:
    """Whether no rigid bodies are as near to the free estimates as the truth would be."""
    if not found.reached:
        return [
            f"the free estimates are {found.distance:.2g} standard errors away from what any rigid "
            f"bodies have, and their errors explain {found.explained:.2g}: {CAUSE}"
        ]
    within = evidence.diagnostics.width * evidence.diagnostics.consequences.torque
    far = np.flatnonzero(found.moved > within)
    if not len(far):
        return []
    return [
        f"any rigid bodies move the torque of {joints_named((far + 1).tolist())} by "
        f"{percents(found.moved[far].tolist())}, more than its interval: {CAUSE}"
    ]


def _inertia_negative(evidence: Evidence) -> dict[int, float]:
    """The diagonal of the inertia matrix, of the joints (from 1) at which it is negative."""
    diagonal = evidence.diagnostics.consequences.diagonal
    return {j: float(x) for j, x in enumerate(diagonal, start=1) if x < 0.0}


def _friction_known(evidence: Evidence, robot: Robot) -> list[tuple[tuple[int, ...], str, float]]:
    """The joints, name and estimate of each friction parameter that is significantly not 0."""
    friction = {p.name: p.term.joints for p in robot.parameters if p.term.NEVER_NEGATIVE}
    errors = evidence.diagnostics.errors
    return [
        (friction[name], name, float(estimate))
        for name, estimate, error in zip(evidence.names, evidence.estimates, errors, strict=True)
        if name in friction and abs(estimate) > DEVIATIONS * error
    ]


def _unknown(evidence: Evidence) -> list[str]:
    """Parameters whose standard error exceeds 30 % of their value, or is not known."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = 100.0 * evidence.diagnostics.errors / np.abs(evidence.estimates)
    return [n for n, r in zip(evidence.names, relative, strict=True) if not r <= DOUBT]


def _summary(evidence: Evidence) -> str:
    """The key figures: known parameters, torques and inertias, R2 of each joint, condition."""
    unknown = _unknown(evidence)
    count = len(evidence.names)
    known = f"{count - len(unknown)} of {count} parameters known within {DOUBT:g} %"
    if 0 < len(unknown) <= FEW:
        known += f" (all but {listed(unknown)})"
    found, width = evidence.diagnostics.consequences, evidence.diagnostics.width
    parts = [known]
    if np.isfinite(found.torque).all():
        torques = percents_of_joints(width * found.torque)
        parts.append(f"model torque within {torques} on motions like this one")
    needed = evidence.diagnostics.needed
    if np.isfinite(needed).all():
        parts.append(f"needed torque within {percents_of_joints(needed)}")
    residuals = np.array([joint.relative_error for joint in evidence.diagnostics.joints])
    if np.isfinite(residuals).all():
        parts.append(f"residual {percents_of_joints(0.01 * residuals)}")
    if np.isfinite(found.inertia).all():
        parts.append(f"inertia within {percents_of_joints(width * found.inertia)}")
    r2 = [joint.r2 for joint in evidence.diagnostics.joints]
    parts.append(f"R2 {of_joints(['undefined' if np.isnan(x) else f'{x:.4f}' for x in r2])}")
    if np.isfinite(evidence.condition):
        parts.append(f"condition number {evidence.condition:.3g}")
    return "; ".join(parts)


def combination(direction: Array, names: Sequence[str]) -> str:
    """A direction in parameter space as a sum; parts below a tenth of the largest are left out."""
    unit = direction / direction[int(np.argmax(np.abs(direction)))]
    parts = sorted(
        ((x, n) for x, n in zip(unit, names, strict=True) if abs(x) > 0.1),
        key=lambda part: -abs(part[0]),
    )
    text = " ".join(f"{'-' if x < 0 else '+'} {_factor(x)}{name}" for x, name in parts)
    return text.removeprefix("+ ")


def _factor(x: float) -> str:
    text = f"{abs(x):.2g}"
    return "" if text == "1" else f"{text} "
