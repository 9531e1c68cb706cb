"""Entries for the torque of each joint: friction, what else pulls, and how it was logged."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from scarid_cli.algorithms.beyond.curves import laws
from scarid_cli.algorithms.beyond.phenomenon import (
    Composite,
    Fitted,
    Found,
    Part,
    Shape,
    side_by_side,
)
from scarid_cli.algorithms.beyond.signals import Signals, diagonal
from scarid_cli.algorithms.robots import terms
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array
from scarid_cli.words import listed

if TYPE_CHECKING:
    from scarid_cli.algorithms.beyond.additions import Addition

DECREASES = (
    "friction of {joints} decreases with speed (add Stribeck friction with --estimator separable)"
)


class Offset(Shape):
    """A constant: the zero of a drive or of a torque sensor, or friction with a direction."""

    NAME = "offset"
    UNIT = "{torque}"
    LACKS = (
        "the torque of {joints} has an offset that the model lacks (add the term offset to the "
        "robot)"
    )
    TERMS = ("offset",)
    IMPERFECTIONS = ("torque-offset", "friction-asymmetry")
    CHANGE = "offset"
    FRICTION = "offset or asymmetric Coulomb friction"
    ALWAYS = True
    FITTED = False  # here: effects/offsets.py looks for it beforehand
    COMPARED = True

    @staticmethod
    def shape(x: Signals) -> Array:
        return np.ones_like(x.v)


class Asymmetry(Shape):
    """Viscous friction that differs between the directions: |dq|."""

    NAME = "asymmetry"
    UNIT = "{torque} s/{position}"
    LACKS = (
        "friction of {joints} differs between the two directions (add the terms viscous-forward "
        "and viscous-backward to the robot)"
    )
    TERMS = ("viscous-forward", "viscous-backward")
    FRICTION = "asymmetric viscous friction"

    @staticmethod
    def shape(x: Signals) -> Array:
        return np.abs(x.v)


class Decayed(Shape):
    """Friction that decays with the speed: sign(dq) exp(-(dq / v)^2), v = SPEED times the rms.

    Of several SPEEDs together it is a curve of friction over the speed.
    """

    KIND = "curvature"
    UNIT = "{torque}"
    SPEED: ClassVar[float]

    @classmethod
    def shape(cls, x: Signals) -> Array:
        return x.friction(cls.SPEED)

    @classmethod
    def lacks(cls, found: Found) -> str:
        """The remedy is none where it has been taken."""
        own = {terms.Stribeck.SYMBOL.format(i=j + 1) for j in found.joints}
        if own <= {*found.names}:
            return f"friction of {cls.facts(found)['joints']} is not that of Stribeck's curve"
        return super().lacks(found)


class SlowFriction(Decayed):
    """Friction of the slowest motion."""

    NAME = "slow friction"
    LACKS = DECREASES
    TERMS = ("stribeck",)
    IMPERFECTIONS = ("stribeck",)
    FRICTION = "fall from slow speeds on"
    SPARSE = True
    SPEED = 0.1


class Stribeck(Decayed):
    """Friction of slow motion, as of a film of grease that builds up (Stribeck's curve)."""

    NAME = "Stribeck"
    LACKS = DECREASES
    TERMS = ("stribeck",)
    IMPERFECTIONS = ("stribeck",)
    FRICTION = "fall from medium speeds on"
    ALWAYS = True
    SPEED = 0.3


class Curvature(Decayed):
    """Friction that is not a constant and a part in proportion to the speed."""

    NAME = "curvature"
    LACKS = "friction of {joints} is not the sum of Coulomb and viscous friction"
    TERMS = ("stribeck", "quadratic")
    IMPERFECTIONS = ("stribeck",)
    FRICTION = "curve over the speed"
    SPEED = 1.0

    @classmethod
    def added(cls, fitted: Fitted) -> str:
        """The law that the curve follows, with the term that has it."""
        law = laws(fitted.own, DECAYED, fitted.estimates, fitted.robot)
        lacks = cls.LACKS.format(joints=fitted.joints)
        return f"{lacks}: {law}; a curve over the speed was fitted as well"


# Of the root-mean-square velocity: where the friction of slow motion has decayed.
DECAYED = {kind.NAME: kind.SPEED for kind in (SlowFriction, Stribeck, Curvature)}


class Spring(Shape):
    """A spring or a cable that pulls in proportion to the position; it is slack somewhere."""

    NAME = "spring"
    UNIT = "{torque}/{position}"
    LACKS = "something pulls on {joints} as a spring or a cable does, for which there is no term"

    @staticmethod
    def shape(x: Signals) -> Array:
        return x.q

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return side_by_side(x, (Offset, Spring))


class Saturation(Shape):
    """A logged torque that falls behind the real one as this grows: tau |tau|."""

    NAME = "saturation"
    UNIT = "per {torque}"
    LACKS = (
        "the logged torque of {joints} is not proportional to the real one, as when a motor "
        "saturates"
    )

    @staticmethod
    def shape(x: Signals) -> Array:
        return x.predicted * np.abs(x.predicted)


class Drift(Shape):
    """A torque that grows with the time, as of a sensor that warms up."""

    NAME = "drift"
    UNIT = "{torque}/s"
    LACKS = "the torque of {joints} drifts during the log"
    LASTS = False

    @staticmethod
    def shape(x: Signals) -> Array:
        return np.asarray(x.time - x.time.mean(axis=0))


class Warming(Shape):
    """Friction that changes in proportion to the time, as while a robot warms up.

    Its size is the change from the start to the end of the log, over the mean friction.
    """

    NAME = "warming"
    UNIT = "of this friction from start to end"
    LACKS = "friction of {joints} changes during the log, as while a robot warms up"
    IMPERFECTIONS = ("friction-drift",)
    LASTS = False

    @staticmethod
    def shape(x: Signals) -> Array:
        since = x.time - x.time.mean(axis=0)
        return np.asarray(x.rubbing * since / (float(np.ptp(x.time)) or 1.0))

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return diagonal(cls.shape(x)) if x.model and x.rubbing.any() else None


class RelativeGain(Shape):
    """A torque that was logged too large or too small, relative to those of the other joints.

    What joints have in common says how their torques fit together. What is found is told by
    inference/gains.py.
    """

    NAME = "gain"
    UNIT = "of this torque"
    IMPERFECTIONS = ("torque-constant-error",)
    CHANGE = "motor constant"
    RELATIVE = COMPARED = True

    @staticmethod
    def shape(x: Signals) -> Array:
        return x.predicted * x.others


class LoadFriction(Shape):
    """Friction that grows with the torque that the gears transmit, which only a model can tell."""

    NAME = "load"
    UNIT = "of this torque"
    LACKS = "friction of {joints} grows with the transmitted torque, for which there is no term"
    IMPERFECTIONS = ("load-friction",)
    FRICTION = "growth with the load"
    RANGE = (0.0, 1.0)  # of the load, of which friction takes a part away

    @staticmethod
    def shape(x: Signals) -> Array:
        return np.sign(x.v) * np.abs(x.transmitted)

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return diagonal(cls.shape(x)) if x.model else None


class Cube(Part):
    """What a cable pulls more than in proportion to the position."""

    NAME = "cable as a cube"
    UNIT = "{torque}/{position}3"
    KIND = "cable"

    @staticmethod
    def shape(x: Signals) -> Array:
        return x.q**3


class Cable(Composite):
    """A cable, which pulls as a spring does, and more than in proportion where it is bent far."""

    NAME = "cable"
    LACKS = (
        "something pulls on {joints} more than in proportion to the position, as a bent cable "
        "does, for which there is no term"
    )
    PARTS = (Spring, Cube)

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return side_by_side(x, (Offset, *cls.PARTS))

    @classmethod
    def sizes(cls, fitted: Fitted) -> str:
        """`0.02 N m/rad and 0.1 N m/rad3 at joint 1`, and so on."""
        kinds = {part.NAME: part for part in cls.PARTS}
        found: dict[int, list[str]] = {}
        for x in sorted(fitted.own, key=lambda x: x.name, reverse=True):  # the spring first
            text = f"{x.size:.3g} {kinds[x.name].unit(fitted.joint(x))}"
            found.setdefault(x.joint, []).append(text)
        return ", ".join(f"{listed(found[j])} at joint {j + 1}" for j in sorted(found))


class Wave(Composite):
    """A sine and a cosine of each joint, whose phase is not known."""

    @classmethod
    def added(cls, fitted: Fitted) -> str:
        """With the amplitudes, and the periods where these were searched for."""
        own, units = ripples(fitted.own), [joint.torque_unit for joint in fitted.robot.joints]
        lacks = cls.LACKS.format(joints=fitted.joints, periods=periods(own, fitted.robot))
        sizes = at_joints(((j, size) for (j, _), size in own.items()), units)
        return f"{lacks}; fitted as well, with {sizes}"


class RippleSine(Part):
    """The sine of a ripple."""

    NAME = "ripple as a sine"
    UNIT = "{torque}"
    KIND = "ripple"

    @staticmethod
    def shape(x: Signals) -> Array:
        return x.ripple(np.sin)


class RippleCosine(RippleSine):
    """The cosine of a ripple."""

    NAME = "ripple as a cosine"

    @staticmethod
    def shape(x: Signals) -> Array:
        return x.ripple(np.cos)


class Ripple(Wave):
    """A torque that ripples with the position; its periods are searched for."""

    NAME = "ripple"
    LACKS = (
        "the torque of {joints} ripples with the position ({periods}), as of cogging motors or of "
        "gears, for which there is no term"
    )
    IMPERFECTIONS = ("ripple",)
    FRICTION = "ripple"
    SPARSE = True
    PARTS = (RippleSine, RippleCosine)

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        if not len(x.ripples):
            return None
        each = [side_by_side(replace(x, ripples=own[None]), cls.PARTS) for own in x.ripples]
        return np.concatenate(each, axis=2)

    @classmethod
    def facts(cls, found: Found) -> dict[str, str]:
        there = [(j, x) for j in found.joints for x in found.cycles[:, j] if x]
        return {**super().facts(found), "periods": periods(there, found.robot)}


class UnevenSine(Part):
    """Coulomb friction times the sine of the position."""

    NAME = "uneven friction as a sine"
    UNIT = "{torque}"
    KIND = "uneven friction"

    @staticmethod
    def shape(x: Signals) -> Array:
        return np.sign(x.v) * np.sin(x.q) * x.turns


class UnevenCosine(UnevenSine):
    """Coulomb friction times the cosine of the position."""

    NAME = "uneven friction as a cosine"

    @staticmethod
    def shape(x: Signals) -> Array:
        return np.sign(x.v) * np.cos(x.q) * x.turns


class Uneven(Wave):
    """Coulomb friction that varies over a turn, as of gears that are not round."""

    NAME = "uneven friction"
    LACKS = (
        "Coulomb friction of {joints} varies over a turn, as of gears that are not round, for "
        "which there is no term"
    )
    FRICTION = "Coulomb friction that varies over a turn"
    PARTS = (UnevenSine, UnevenCosine)


RippleAt = tuple[int, float]  # the joint (from 0) and the periods per rad or m


def ripples(added: Sequence[Addition]) -> dict[RippleAt, float]:
    """The amplitude of each ripple, from those of its sine and its cosine."""
    found: dict[RippleAt, list[float]] = {}
    for x in added:
        found.setdefault((x.joint, x.cycles), []).append(x.size)
    return {ripple: float(np.linalg.norm(sizes)) for ripple, sizes in found.items()}


def periods(at: Sequence[RippleAt] | Mapping[RippleAt, float], robot: Robot) -> str:
    """`10 periods per rad at joint 1, 8 and 16 periods per rad at joint 2`."""
    return at_joints(list(at), [f"periods per {joint.unit}" for joint in robot.joints])


def at_joints(values: Iterable[tuple[int, float]], units: Sequence[str]) -> str:
    """Values of joints (from 0), with the units of these: `0.1 N m at joint 1, 2 N at joint 2`."""
    own: dict[int, list[str]] = {}
    for j, value in values:
        own.setdefault(j, []).append(f"{value:.3g}")
    return ", ".join(f"{listed(texts)} {units[j]} at joint {j + 1}" for j, texts in own.items())
