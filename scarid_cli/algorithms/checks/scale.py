"""Whether the torques have the size that the described masses need: currents, or another unit.

The torque of each joint is fitted by one factor times the torque of the masses and inertias that
the description states, beside friction, an offset, the inertia of the motor (where the description
has links of its own) and the derivative of the torque. In the unit of the description the factor
is 1. Masses of a CAD model may be wrong, and a tool that it lacks makes the factors of the last
joints larger: only what neither explains is called another unit.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.checks.finding import Finding, failed, joints_text, ok
from scarid_cli.algorithms.checks.model import DEVIATIONS, EXACT, Samples, Solution, solved
from scarid_cli.algorithms.checks.units import prefixed
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.planar import PlanarTerm
from scarid_cli.algorithms.robots.terms import Mass, StandardTerm
from scarid_cli.arrays import Array, Marks
from scarid_cli.interval import plus_minus

MASSES = (StandardTerm, PlanarTerm, Mass)
WRONG = 2.0  # a factor that the masses of a CAD model, or a tool, may be off by
KNOWN = 0.1  # of a factor: its standard error, from which on nothing is said of it

ALIKE = 1e6  # by which the other columns may inflate the variance of a factor: beyond is rounding


@dataclass(frozen=True)
class Scale:
    """The torques over those that the masses need (joints), the errors, and what these need.

    Factors and errors are nan where the masses need no torque; `needed` (joints) is its root mean
    square.
    """

    factors: Array
    errors: Array
    needed: Array

    @property
    def known(self) -> list[int]:
        """The joints (from 0) whose factors are known well enough to be told."""
        return np.flatnonzero(self.errors < KNOWN * np.abs(self.factors)).tolist()

    @property
    def reversed(self) -> bool:
        """Whether the masses need the opposite of every torque whose factor is known."""
        return bool(self.known) and bool(np.all(self.factors[self.known] < 0.0))

    @property
    def low(self) -> list[int]:
        """The joints (from 0) whose torques are smaller than any mass that is wrong makes them.

        A negative factor is no unit: a centre of mass is described on the wrong side.
        """
        most = self.factors + DEVIATIONS * self.errors
        return [j for j in self.known if self.factors[j] > 0.0 and most[j] < 1.0 / WRONG]

    @property
    def high(self) -> list[int]:
        """The joints (from 0) whose torques are larger than a tool at the tip makes them.

        It adds most to the joints near it, so a joint is compared with those behind it whose
        factors are known; it does not double the torque of the joint that carries most; and what it
        adds to a joint it adds to one before it as well, which is further from it.
        """
        spread = DEVIATIONS * self.errors
        least, most = self.factors - spread, self.factors + spread
        above = [j for j in self.known if least[j] > WRONG]
        if above == self.known and int(np.argmax(self.needed)) in above:
            return above
        return [j for j in above if self._beyond_a_tool(j, least, most)]

    @property
    def of_a_unit(self) -> bool:
        """Whether all torques are as in one other unit, which no load makes them.

        No load halves the torques of several joints at once, or makes them a thousand times as
        large.
        """
        every = len(self.low or self.high) == len(self.known) > 1
        return every and bool(self.low or _prefix(self))

    @property
    def agrees(self) -> bool:
        """Whether the torques are about those that the masses need, as far as is known."""
        return bool(self.known) and not (self.low or self.high or self.reversed)

    def corrected(self, samples: Samples) -> Samples:
        """The samples with the torques of another unit in that of the description."""
        wrong = self.low or self.high
        units = np.ones(len(self.factors))
        units[wrong] = self.factors[wrong]
        motion = samples.motion.copy()
        motion[3:] /= units[:, None]
        return replace(samples, motion=motion)

    def _beyond_a_tool(self, j: int, least: Array, most: Array) -> bool:
        """Whether the torque of joint j (from 0) is larger than a tool makes it.

        The masses that are described may be wrong as well: the joints before it may need less than
        they state without the tool, as far as those of this log disagree with them, but not half,
        and joint j twice as much.
        """
        behind = [most[k] for k in self.known if k > j]
        if behind and least[j] > WRONG * max(1.0, *behind):
            return True
        off = max((max(most[k] - 1.0, 1.0 - least[k]) for k in self.known if k < j), default=0.0)
        bare = 1.0 - min(off, 1.0 - 1.0 / WRONG)
        added = [(most[k] - bare) * self.needed[k] for k in self.known if k < j]
        return bool(added) and (least[j] - WRONG) * self.needed[j] > WRONG * max(added)


def scale_of(robot: Robot, samples: Samples) -> Scale:
    """The factors of a robot's torques in these samples."""
    needed, beside = _columns(robot, samples)
    tau = samples.motion[3]
    found = [
        _factor(needed[j], [x[j] for x in beside], tau[j], samples.counts[j])
        for j in range(len(tau))
    ]
    sizes = np.sqrt(np.mean(needed**2, axis=1))
    factors, errors = np.transpose(found)
    return Scale(factors, errors, sizes)


def disagreement(robot: Robot, samples: Samples) -> float:
    """How little of the torques the described masses explain, by factors that are not negative.

    The mean over joints of the logarithm of what they leave of the mean square that friction, an
    offset and the motor leave by themselves, which is all where they need nothing else than these;
    nan if nothing is described that needs torques.
    """
    needed, beside = _columns(robot, samples)
    tau, left = samples.motion[3], []
    for j in np.flatnonzero(needed.any(axis=1)):
        counts, own = samples.counts[j], np.column_stack([x[j] for x in beside])[:, None, :]
        with_masses = np.concatenate((needed[j][:, None, None], own), axis=2)
        found, without = (solved(W, tau[[j]], counts[None]) for W in (with_masses, own))
        share = found.residuals[0] / max(without.residuals[0], EXACT)
        left.append(min(share, 1.0) if found.theta[0] > 0.0 and _apart(found) else 1.0)
    return float(np.mean(np.log(np.maximum(left, EXACT)))) if left else np.nan


def _columns(robot: Robot, samples: Samples) -> tuple[Array, list[Array]]:
    """The torques (joints, samples) of the described masses and inertias, and the other columns."""
    q, dq, ddq, _, slope = samples.motion
    masses = np.array([isinstance(p.term, MASSES) for p in robot.parameters])
    needed = robot.torques(robot.regressor(q, dq, ddq), np.where(masses, robot.apriori, 0.0))
    return needed, [dq, np.sign(dq), np.ones_like(q), slope, *([ddq] if robot.body else [])]


def _factor(needed: Array, beside: list[Array], tau: Array, counts: Marks) -> tuple[float, float]:
    """The factor and its standard error; nan where nothing tells it."""
    if not needed[counts].any():
        return np.nan, np.nan
    W = np.column_stack([needed, *beside])[:, None, :]
    found = solved(W, tau[None], counts[None])
    if not _apart(found):
        return np.nan, np.nan
    return float(found.theta[0]), float(found.scatter(1)[0])


def _apart(found: Solution) -> bool:
    """Whether the first column is unlike all that the others can be."""
    return bool(found.inverse[0, 0] * np.sum(found.stacked[:, 0] ** 2) <= ALIKE)


def finding(robot: Robot, scale: Scale) -> Finding:
    """What the factors say."""
    if not scale.known:
        why = "the motion does not show it" if robot.apriori.any() else "no masses are described"
        return ok("scale", f"not known: {why}")
    wrong = scale.low or scale.high
    if not wrong:
        figure = f"torques {_listed(scale, scale.known)} of what the described masses need"
        return ok("scale", figure)
    every = len(wrong) == len(robot.joints)
    whose = "the torques are" if every else f"the torque of {joints_text(j + 1 for j in wrong)} is"
    figure = f"{whose} {_listed(scale, wrong)} of what the described masses need"
    if every and (prefix := _prefix(scale)):
        return failed("scale", figure, prefixed(prefix, robot))
    return failed("scale", figure, _advice(robot, scale, wrong, every=every))


def _prefix(scale: Scale) -> str:
    """The prefix of the unit, m or k, if the factors are near to its factor of a thousand."""
    for prefix, factor in (("m", 1000.0), ("k", 0.001)):
        if np.all(np.abs(np.log(scale.factors[scale.known] / factor)) < np.log(WRONG)):
            return prefix
    return ""


def _listed(scale: Scale, joints: list[int]) -> str:
    """`0.098 +- 0.004`, for each of these joints (from 0)."""
    return ", ".join(
        f"{scale.factors[j]:.3g} {plus_minus(scale.errors[j], 1)}"
        + (f" (joint {j + 1})" if len(joints) > 1 else "")
        for j in joints
    )


def _advice(robot: Robot, scale: Scale, wrong: list[int], *, every: bool) -> str:
    """What to state: the torque that one unit of the log is, from a data sheet."""
    columns = "'tau*" if every else f"'tau{wrong[0] + 1}"
    unit = robot.joints[wrong[0]].torque_unit
    about = ", ".join(f"{1.0 / scale.factors[j]:.3g}" for j in wrong)
    return (
        "currents, percent or another unit (or a wrong clock)? State the torque of one unit (by "
        f"these masses about {about} {unit}): `scarid convert --unit {columns}=X {unit}'`, or "
        "torque_constant in [log] of the TOML file; if the masses are no real ones, masses = "
        '"placeholder" in it'
    )
