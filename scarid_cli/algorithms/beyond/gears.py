"""Entries for what lies between a log and its robot: late signals, gears, friction with a memory.

The position of one joint or its torque may be older than the other signals, a gear yields by the
torque that it carries or has a gap, and friction and torques may depend on where they came from.
With its size s the torques become what the docstring of the entry says, where tau_t is the torque
that the joint transmits, and a play follows a signal at a distance of at most s. What jumps passes
the low-pass of the rows. They are not linear in s: a column is the secant (tau(s) - tau(0)) / s at
a size that is known already, or else at a small one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from scarid_cli.algorithms.beyond.model import MOTORS, Model
from scarid_cli.algorithms.beyond.phenomenon import Fitted, Phenomenon
from scarid_cli.algorithms.filters.two_sided import two_sided_taps
from scarid_cli.algorithms.regression.low_pass import LowPass
from scarid_cli.algorithms.regression.rows import Rows, curvature, delay_column, runs, slope
from scarid_cli.arrays import Array
from scarid_cli.interval import plus_minus
from scarid_cli.words import listed

if TYPE_CHECKING:
    from scarid_cli.algorithms.beyond.additions import Addition

YIELDS = 2  # times that the torque is computed where the joint has yielded: more amplify noise
DERIVATIVES = 2 * YIELDS  # samples on either side that these need
MEMORY = 1.0  # s: no row depends on those that are farther away than what jumps and what plays need


@dataclass(frozen=True)
class Gears:
    """The signals of a robot with the parameters `theta`, which are the first columns of W."""

    rows: Rows
    model: Model
    theta: Array

    def predicted(self, joint: int) -> Array:
        """All torques of a joint (samples)."""
        return np.asarray(self.rows.W[:, joint, : len(self.theta)] @ self.theta)

    def own(self, joint: int, torque: Array) -> Array:
        """The column (samples, joints) of a torque of this joint alone."""
        column = np.zeros_like(self.rows.y)
        column[:, joint] = torque
        return column

    def coulomb(self, joint: int) -> float:
        """The Coulomb friction of a joint, 0 without this term."""
        terms = [self.model.robot.parameters[i].term for i in self.model.kept]
        own = [term.NAME == "coulomb" and term.joints == (joint + 1,) for term in terms]
        return float(np.sum(self.theta[own]))

    def passed(self, x: Array) -> Array:
        """A signal (samples) behind the low-pass of the rows, if this is known."""
        rows = self.rows
        low_pass = LowPass.behind(rows)
        if low_pass is None:
            return x
        taps = two_sided_taps(low_pass.cutoff, low_pass.order, int(MEMORY / rows.h))
        half, found = len(taps) // 2, np.empty_like(x)
        for run in runs(rows.at):
            found[run] = np.convolve(np.pad(x[run], half, mode="edge"), taps, "valid")
        return found

    @cached_property
    def links(self) -> Array:
        """The torques (samples, joints) of the links."""
        return self._of(self.rows.motion[:3])

    def behind(self, joint: int, distance: Array) -> Array:
        """Those with the link of a joint so far behind its encoder (samples)."""
        speed = slope(self.rows, distance)
        yielded = np.stack((distance, speed, slope(self.rows, speed)))
        return self.torques(joint, self.rows.motion[:3, joint] - yielded)

    def torques(self, joint: int, own: Array) -> Array:
        """Those with another motion (3, samples) of a joint."""
        motion = self.rows.motion[:3].copy()
        motion[:, joint] = own
        return self._of(motion)

    def _of(self, motion: Array) -> Array:
        return self.model.link_torques(np.ascontiguousarray(motion), self.theta)


class Mismatch(Phenomenon):
    """One of these, which effects/mismatched.py searches for; SMALL is small for any robot."""

    RANGE = (0.0, np.inf)  # it yields in the direction of the torque, and what is late is not early
    SMALL: ClassVar[float] = 0.0
    PLAYS: ClassVar[bool] = False  # whether it follows a signal at a distance
    JUMPS: ClassVar[bool] = False  # whether it passes the low-pass of the rows
    SCALE: ClassVar[float] = 1.0  # what is told per unit of the size
    DIGITS: ClassVar[int] = 3  # of what is told

    @classmethod
    def secant(cls, of: Gears, joint: int, size: float = np.nan) -> Array:
        """The column of a joint (from 0), per unit of its size (samples, joints).

        `size` is where the secant ends, nan if that is not known.
        """
        return cls.column(of, joint, cls.SMALL if np.isnan(size) else size)

    @staticmethod
    def column(of: Gears, joint: int, s: float) -> Array:
        """The column where the secant ends at the size s, which is 0 where SMALL is."""
        raise NotImplementedError

    @classmethod
    def reach(cls, h: float) -> int:
        """The samples on either side, h [s] apart, that the column depends on."""
        seconds = MEMORY * (cls.PLAYS + cls.JUMPS)
        return DERIVATIVES + (int(np.ceil(seconds / h)) if h > 0.0 else 0)

    @classmethod
    def sizes(cls, fitted: Fitted) -> str:
        """`117 +- 4 N m/rad at joint 1 and 98 +- 3 N m/rad at joint 2`."""
        return listed([cls.size_of(x, fitted) for x in fitted.own])

    @classmethod
    def size_of(cls, one: Addition, fitted: Fitted) -> str:
        """`117 +- 4 N m/rad at joint 1`, with half the 95 % interval."""
        value, error = cls.told(one.size, one.error)
        unit = cls.unit(fitted.joint(one))
        return f"{value:.{cls.DIGITS}g} {plus_minus(error)} {unit} at joint {one.joint + 1}"

    @classmethod
    def told(cls, size: float, error: float) -> tuple[float, float]:
        """What is told of the size and its error, in the UNIT."""
        return cls.SCALE * size, cls.SCALE * error


class LatePosition(Mismatch):
    """A position that is older than the other signals: tau(q_j(t + s))."""

    NAME = "late position"
    UNIT, SCALE = "ms", 1e3
    LACKS = "the position of {joints} is older than the other signals"
    IMPERFECTIONS = ("position-delay",)
    SMALL = 1e-4

    @staticmethod
    def column(of: Gears, joint: int, s: float) -> Array:
        q, dq, ddq = of.rows.motion[:3, joint]
        jerk = slope(of.rows, ddq)
        later = np.stack((
            q + s * dq + 0.5 * s**2 * ddq,
            dq + s * ddq + 0.5 * s**2 * jerk,
            ddq + s * jerk + 0.5 * s**2 * slope(of.rows, jerk),
        ))  # fmt: skip
        column = (of.torques(joint, later) - of.links) / s
        rest = of.predicted(joint) - of.links[:, joint]  # friction and motor
        column[:, joint] += delayed(of.rows, joint, rest, s)
        return column


class LateTorque(Mismatch):
    """A torque that is older than the other signals: tau_j(t - s)."""

    NAME = "late torque"
    UNIT, SCALE = "ms", 1e3
    LACKS = "the torque of {joints} is older than the other signals"
    IMPERFECTIONS = ("torque-delay",)

    @staticmethod
    def column(of: Gears, joint: int, s: float) -> Array:
        return of.own(joint, -delayed(of.rows, joint, of.predicted(joint), -s))


class ElasticGear(Mismatch):
    """A gear or belt that yields behind the encoder: tau_links(q_j - s tau_t), s in rad/(N m)."""

    NAME = "elastic gear"
    UNIT = "{torque}/{position}"
    LACKS = "something yields between encoder and link of {joints} (an elastic gear or belt)"
    IMPERFECTIONS = ("flexibility", "encoder-side")
    WIDER = ("elasticity", "signals")
    SMALL = 1e-6

    @classmethod
    def column(cls, of: Gears, joint: int, s: float) -> Array:
        torques = of.links
        for _ in range(1 if s == cls.SMALL else YIELDS):
            torques = of.behind(joint, s * torques[:, joint])
        return np.asarray((torques - of.links) / s)

    @staticmethod
    def told(size: float, error: float) -> tuple[float, float]:
        return 1.0 / size, error / size**2

    @classmethod
    def size_of(cls, one: Addition, fitted: Fitted) -> str:
        """The stiffness, which is a bound where the inertia behind the gear is not known.

        The links yield by what they need themselves. A parameter that has the inertia of motor and
        links together makes the inertial part of it too large, by the square of their ratio.
        """
        text, terms = super().size_of(one, fitted), (p.term for p in fitted.robot.parameters)
        if any(isinstance(term, MOTORS) and one.joint + 1 in term.joints for term in terms):
            return text
        return f"at most {text} (less by the motor's part of the inertia there)"


class ElasticJoint(Mismatch):
    """A joint that yields before the encoder on the link: tau_j + s d2(tau_t)/dt2, s in s2."""

    NAME = "elastic joint"
    UNIT = "Hz"
    LACKS = "motor and link of {joints} oscillate against each other, the encoder on the link"
    IMPERFECTIONS = ("flexibility",)
    WIDER = ("elasticity", "signals")

    @staticmethod
    def column(of: Gears, joint: int, _: float) -> Array:
        return of.own(joint, of_joint(of.rows, joint, of.links[:, joint], curvature))

    @staticmethod
    def told(size: float, error: float) -> tuple[float, float]:
        frequency = 0.5 / (np.pi * np.sqrt(size))
        return frequency, 0.5 * frequency * error / size


class Backlash(Mismatch):
    """A gap in the gear, twice s wide, behind the encoder: tau_links(q_j - s sign(tau_t))."""

    NAME = "backlash"
    UNIT, SCALE, DIGITS = "{position}", 2.0, 2  # the whole distance
    LACKS = "there is a gap in the gear of {joints} (backlash), with the encoder on the motor"
    WIDER = ("backlash",)
    SMALL = 1e-4
    JUMPS = True

    @staticmethod
    def column(of: Gears, joint: int, s: float) -> Array:
        side = of.passed(np.sign(of.links[:, joint]))
        return np.asarray((of.behind(joint, s * side) - of.links) / s)


class Hysteresis(Mismatch):
    """A hysteresis, as of a torque sensor: the play of tau_j by s."""

    NAME = "hysteresis"
    UNIT = "{torque}"
    LACKS = "the torque of {joints} has a hysteresis, as of its sensor"
    WIDER = ("hysteresis",)
    PLAYS = JUMPS = True

    @staticmethod
    def column(of: Gears, joint: int, s: float) -> Array:
        torque = of.predicted(joint)
        if not s:
            return of.own(joint, of.passed(-np.sign(slope(of.rows, torque))))
        return of.own(joint, of.passed((played(of.rows, torque, s) - torque) / s))


class Presliding(Mismatch):
    """Friction that builds up over a distance of twice s behind a reversal.

    It is Coulomb friction times (q_j - play of q_j by s) / s in place of sign(dq_j).
    """

    NAME = "presliding"
    UNIT, SCALE, DIGITS = "{position}", 2.0, 2  # the whole distance
    LACKS = "friction of {joints} builds up over a distance behind a reversal (presliding)"
    WIDER = ("presliding",)
    SMALL = 1e-2
    PLAYS = JUMPS = True

    @staticmethod
    def column(of: Gears, joint: int, s: float) -> Array:
        q, dq = of.rows.motion[:2, joint]
        share = (q - played(of.rows, q, s)) / s - np.sign(dq)
        return of.own(joint, of.passed(of.coulomb(joint) * share / s))


def played(rows: Rows, x: Array, size: float) -> Array:
    """The play of a signal (samples): it follows at a distance of at most `size`.

    It knows the signal of the last MEMORY only, so that no row depends on those long before it.
    """
    steps = int(MEMORY / rows.h) if rows.h > 0.0 else 0
    found = np.empty_like(x)
    for run in runs(rows.at):
        count = run.stop - run.start
        around = np.pad(x[run], (steps, 0), mode="edge")
        now = around[:count]
        for k in range(1, steps + 1):
            here = around[k : k + count]
            now = np.clip(now, here - size, here + size)
        found[run] = now
    return found


def delayed(rows: Rows, joint: int, torque: Array, s: float) -> Array:
    """(torque(t + s) - torque(t)) / s of a joint, to second order; 0 where it reverses."""
    first = of_joint(rows, joint, torque, delay_column)
    return first + 0.5 * s * of_joint(rows, joint, torque, curvature)


def of_joint(
    rows: Rows, joint: int, torque: Array, derivative: Callable[[Rows, Array], Array]
) -> Array:
    torques = np.zeros_like(rows.y)
    torques[:, joint] = torque
    return np.asarray(derivative(rows, torques)[:, joint])
