"""What every entry of the catalogue states, and how it is said."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from scarid_cli.algorithms.beyond.signals import Signals, diagonal
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.joints import Joint
from scarid_cli.arrays import Array
from scarid_cli.words import joints_named, listed

if TYPE_CHECKING:
    from scarid_cli.algorithms.beyond.additions import Addition


@dataclass(frozen=True)
class Found:
    """What the log of a robot shows of an entry: the joints (from 0), and amounts with their noise.

    `cycles` (ripples, joints) are the periods of ripples per rad or m, and `names` those of all
    parameters that were estimated, which an estimator may have added to those of the robot.
    """

    robot: Robot
    joints: Sequence[int]
    amounts: Array
    noise: Array
    cycles: Array
    names: Sequence[str] = ()


@dataclass(frozen=True)
class Fitted:
    """The additions of an entry beside the estimates of a robot's parameters."""

    robot: Robot
    own: Sequence[Addition]
    estimates: Mapping[str, float]

    @property
    def joints(self) -> str:
        """`joint 2`, or `joints 1 and 3`."""
        return joints_named(dict.fromkeys(x.joint + 1 for x in self.own))

    def joint(self, one: Addition) -> Joint:
        """That of an addition."""
        return self.robot.joints[one.joint]


class Phenomenon:
    """Something that a log may have beyond the model of its robot.

    A subclass states its NAME in tables, and what the model LACKS, as a sentence that names the
    `{joints}` and ends with the remedy, if there is one. Without a sentence it widens intervals,
    but is not named.
    """

    NAME: ClassVar[str]
    LACKS: ClassVar[str] = ""
    KIND: ClassVar[str] = ""  # the entry as which it is told where it was fitted, if not its own
    TERMS: ClassVar[tuple[str, ...]] = ()  # of a robot description, that model it
    IMPERFECTIONS: ClassVar[tuple[str, ...]] = ()  # of `scarid simulate --with`, that cause it
    CHANGE: ClassVar[str] = ""  # what `scarid validate` calls it where it differs between two logs
    UNIT: ClassVar[str] = ""  # of its size, of the {torque} and the {position} of a joint
    RANGE: ClassVar[tuple[float, float] | None] = None  # of the sizes that there can be
    FRICTION: ClassVar[str] = ""  # what `scarid identify --friction auto` calls it
    ALWAYS: ClassVar[bool] = False  # whether it widens intervals though it is not significant
    FITTED: ClassVar[bool] = False  # whether it is fitted where it alone explains the torques
    LASTS: ClassVar[bool] = True  # whether it belongs to the robot, and not to one log
    RELATIVE: ClassVar[bool] = False  # whether its columns depend on the estimates beside them
    COMPARED: ClassVar[bool] = False  # whether a comparison of logs has columns for it by itself
    SPARSE: ClassVar[bool] = False  # whether it shows in few blocks of time, too few at times
    TOGETHER: ClassVar[bool] = False  # whether all joints are likely to have what some have
    FIRST: ClassVar[int] = 0  # columns that are tried by themselves as well
    WIDER: ClassVar[tuple[str, ...]] = ()  # what other joints may have where it was fitted

    @classmethod
    def kind(cls) -> str:
        """The entry as which it is told where it was fitted."""
        return cls.KIND or cls.NAME

    @classmethod
    def parts(cls) -> tuple[type[Phenomenon], ...]:
        """The entries as which it is fitted."""
        return (cls,)

    @classmethod
    def possible(cls, size: float) -> bool:
        """Whether there is such a thing of this size."""
        return cls.RANGE is None or cls.RANGE[0] < size < cls.RANGE[1]

    @classmethod
    def unit(cls, joint: Joint) -> str:
        """The unit of the size at this joint."""
        return cls.UNIT.format(torque=joint.torque_unit, position=joint.unit)

    @classmethod
    def lacks(cls, found: Found) -> str:
        """What the model lacks, with the remedy."""
        return cls.LACKS.format_map(cls.facts(found))

    @classmethod
    def facts(cls, found: Found) -> dict[str, str]:
        """What the sentence names."""
        return {"joints": joints_named(j + 1 for j in found.joints) if found.joints else ""}

    @classmethod
    def added(cls, fitted: Fitted) -> str:
        """What the model lacks where it was fitted, and how large it is."""
        lacks = cls.LACKS.format(joints=fitted.joints)
        return f"{lacks}; fitted as well: {cls.sizes(fitted)}"

    @classmethod
    def sizes(cls, fitted: Fitted) -> str:
        """How large it is at each joint."""
        raise NotImplementedError


class OfTorques(Phenomenon):
    """An entry for the torques, with columns beside those of the parameters."""

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        """The columns (samples, joints, k); None where the robot or the log cannot have it."""
        raise NotImplementedError


class Shape(OfTorques):
    """A torque of each joint by itself, of one shape."""

    FITTED = True

    @staticmethod
    def shape(x: Signals) -> Array:
        """The torque of each joint (samples, joints) per unit of its size."""
        raise NotImplementedError

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return diagonal(cls.shape(x))

    @classmethod
    def sizes(cls, fitted: Fitted) -> str:
        """`0.02 and 0.0185 of this torque`, or `0.0993 N m/rad`."""
        units = [cls.unit(fitted.joint(x)) for x in fitted.own]
        sizes = [f"{x.size:.3g}" for x in fitted.own]
        if len(set(units)) == 1:
            return f"{listed(sizes)} {units[0]}"
        return listed([f"{size} {unit}" for size, unit in zip(sizes, units, strict=True)])


class Part(Shape):
    """A shape of a composite entry, and no entry by itself."""


class Composite(OfTorques):
    """An entry that is fitted as several shapes."""

    FITTED = True
    PARTS: ClassVar[tuple[type[Shape], ...]]

    @classmethod
    def parts(cls) -> tuple[type[Phenomenon], ...]:
        return cls.PARTS

    @classmethod
    def columns(cls, x: Signals) -> Array | None:
        return side_by_side(x, cls.PARTS)


def side_by_side(x: Signals, shapes: Sequence[type[Shape]]) -> Array:
    """The columns (samples, joints, k) of these shapes, each of all joints."""
    return np.concatenate([diagonal(shape.shape(x)) for shape in shapes], axis=2)
