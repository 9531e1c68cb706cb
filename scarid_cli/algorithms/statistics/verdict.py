"""The verdict on an estimation: a grade, and its reasons in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.statistics.diagnostics import Diagnostics
from scarid_cli.algorithms.statistics.residuals import JointResidual
from scarid_cli.arrays import Array

GOOD, DOUBTFUL, NOT_IDENTIFIABLE = "good", "doubtful", "not identifiable"
LAGGED = 0.5  # share of the residual above which the lag test finds a bias
DOUBT = 30.0  # %: the relative standard error above which a parameter counts as unknown
WEAK = 1e4  # scaled condition number above which a combination of parameters is undetermined
POOR = 0.8  # R2 below which the model does not explain the torque of a joint
READABLE = 1e4  # deviations from which on a power of ten is printed
DEVIATIONS = 3.0  # standard errors by which an estimate may move
NOISE = 3.0  # times the torque noise: a joint with a smaller torque counts as not driven


@dataclass(frozen=True)
class Verdict:
    """The grade and its reasons, each a sentence without its full stop."""

    grade: str
    reasons: tuple[str, ...]


@dataclass(frozen=True)
class Evidence:
    """What a verdict is based on; `estimates` and errors are in the order of `names`.

    The verdict does not recommend the options of the `treatment` that are already in use.
    `weighted`: joints are weighted by their residuals.
    """

    names: Sequence[str]
    estimates: Array
    condition: float
    scaled_condition: float
    weak: str
    diagnostics: Diagnostics
    treatment: Treatment
    weighted: bool


def verdict(evidence: Evidence, robot: Robot) -> Verdict:
    """Grade an estimation, with the gravest reasons first."""
    joints = evidence.diagnostics.joints
    obstacles = [*_idle(joints, robot), *_undetermined(evidence)]
    if obstacles:
        return Verdict(NOT_IDENTIFIABLE, (*obstacles, *_summary(evidence)))
    unknown = _unknown(evidence)
    wrong = [
        *(_biased(evidence.diagnostics) or _moved(evidence, robot)),
        *_poor(joints),
        *_impossible(evidence, robot),
    ]
    most = 2 * len(unknown) > len(evidence.names)
    uncertain = [f"not {_listed(unknown)}"] if unknown and not most else []
    if most and len(unknown) < len(evidence.names) and not evidence.treatment.essential:
        uncertain = ["--essential leaves out what is not known"]
    grade = DOUBTFUL if wrong or most else GOOD
    return Verdict(grade, (*wrong, *_summary(evidence), *uncertain))


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


def _biased(diagnostics: Diagnostics) -> list[str]:
    if diagnostics.lag_share <= LAGGED:
        return []
    if np.isnan(diagnostics.lag_share):
        return [
            "not tested for bias: too few rows have those 25 ms before and after them; use a "
            "longer log, or leave out fewer rows"
        ]
    return [
        f"biased: the motion 25 ms before and after explains {100 * diagnostics.lag_share:.0f} % "
        "of the residual (signals of different instants, see scarid differentiate --match; noisy "
        "derivatives; or a force that the model lacks)"
    ]


def _moved(evidence: Evidence, robot: Robot) -> list[str]:
    """Estimates that depend on the Coulomb friction of slow rows, or on a delay."""
    diagnostics = evidence.diagnostics
    if not any(p.term.JUMPS for p in robot.parameters):
        return []
    if np.isnan(diagnostics.moved).all():
        return [
            "not tested whether the estimates depend on slow rows: the other rows do not determine "
            "all parameters; use a log that excites every joint"
        ]
    moved = [
        n for n, x in zip(evidence.names, diagnostics.moved, strict=False) if abs(x) > DEVIATIONS
    ]
    if not moved:
        return []
    largest = np.nanmax(np.abs(diagnostics.moved))
    most = f"{largest:.1f}" if largest < READABLE else f"{largest:.1e}"
    slow = [f"{v:.1g}" for v in diagnostics.slow]
    options = _untried(slow, evidence.treatment)
    if options:
        return [
            f"{_listed(moved)} would move by up to {most} deviations without the slow rows and "
            f"with the torques' delay fitted ({' '.join(options)})"
        ]
    advice = "" if evidence.weighted else " (--estimator wls)"
    return [
        f"{_listed(moved)} would move by up to {most} deviations in weighted least squares "
        f"without the rows slower than {', '.join(slow)}{advice}"
    ]


def _untried(slow: Sequence[str], used: Treatment) -> list[str]:
    """The recommended options that are not in use, or only with a lower velocity."""
    options = []
    if len(used.slow) < len(slow) or any(map(_below, used.slow, slow)):
        options.append(f"--drop-slow {','.join(slow)}")
    if not used.align:
        options.append("--align")
    return options


def _below(given: float, advised: str) -> bool:
    return given < float(advised)


def _poor(joints: Sequence[JointResidual]) -> list[str]:
    return [
        f"joint {i} has no R2, because its torque is constant or fewer than two of its rows count"
        if np.isnan(joint.r2)
        else f"the model explains the torque of joint {i} badly (R2 {joint.r2:.3g})"
        for i, joint in enumerate(joints, start=1)
        if not joint.r2 >= POOR
    ]


def _impossible(evidence: Evidence, robot: Robot) -> list[str]:
    """Friction parameters that are significantly negative, which would drive the robot."""
    friction = {p.name for p in robot.parameters if p.term.NEVER_NEGATIVE}
    errors = evidence.diagnostics.errors
    rows = zip(evidence.names, evidence.estimates, errors, strict=True)
    return [
        f"{name} is negative ({estimate:.3g}), which friction cannot be"
        for name, estimate, error in rows
        if name in friction and estimate < -DEVIATIONS * error
    ]


def _unknown(evidence: Evidence) -> list[str]:
    """Parameters whose standard error exceeds 30 % of their value, or is not known."""
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = 100.0 * evidence.diagnostics.errors / np.abs(evidence.estimates)
    return [n for n, r in zip(evidence.names, relative, strict=True) if not r <= DOUBT]


def _summary(evidence: Evidence) -> list[str]:
    """The key figures: known parameters, R2 of each joint, condition number."""
    known = len(evidence.names) - len(_unknown(evidence))
    parts = [f"{known} of {len(evidence.names)} parameters known within {DOUBT:g} %"]
    found = [joint.r2 for joint in evidence.diagnostics.joints]
    r2 = ", ".join("undefined" if np.isnan(x) else f"{x:.4f}" for x in found)
    parts.append(f"R2 {r2}")
    if np.isfinite(evidence.condition):
        parts.append(f"condition number {evidence.condition:.3g}")
    return [", ".join(parts)]


def _listed(names: Sequence[str], most: int = 8) -> str:
    shown = list(names[:most])
    if len(names) > most:
        shown.append(f"{len(names) - most} more")
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


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
