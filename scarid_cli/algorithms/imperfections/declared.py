"""What an imperfection states about itself: its name, its numbers, and what it does.

The first line of a docstring is the line of `scarid simulate --help`; the rest has the equation.
Nothing here imports numpy, so that the help stays quick.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite
from typing import ClassVar

POSITION, TORQUE = "rad or m", "N m or N"  # units of a revolute or of a prismatic joint


@dataclass(frozen=True)
class Number:
    """A number that a user gives: its unit (none for a ratio), its range, and its default.

    `what` names the number where an imperfection has several. Where `words` are given, it is the
    place of one of them.
    """

    unit: str = ""
    low: float = -inf
    high: float = inf
    whole: bool = False
    default: float = 0.0
    what: str = ""
    words: tuple[str, ...] = ()

    def read(self, given: object) -> float:
        """The number that was given as such or as a text; a ValueError says what is wrong."""
        if self.words:
            if given not in self.words:
                raise ValueError(f"{given!r} is none of its words; give {' or '.join(self.words)}")
            return float(self.words.index(str(given)))
        if isinstance(given, bool) or not isinstance(given, int | float | str):
            raise ValueError(f"{given!r} is not a number")
        try:
            value = float(given)
        except (OverflowError, ValueError):
            raise ValueError(f"{given!r} is not a number") from None
        self._check(value)
        return value

    def write(self, value: float) -> str:
        """The number as a user gives it."""
        return self.words[int(value)] if self.words else f"{value:g}"

    def _check(self, value: float) -> None:
        found = f"{self.what} {value:g}".strip()
        if not isfinite(value):
            raise ValueError(f"{found} is not a finite number")
        if self.whole and value % 1:
            raise ValueError(f"{found} is not a whole number")
        if not self.low <= value <= self.high:
            raise ValueError(f"{found} is outside its range; give {self.range}")

    @property
    def range(self) -> str:
        """The range in words."""
        unit = f" {self.unit}" if self.unit else ""
        if self.high == inf:
            return f"{self.low:g}{unit} or more"
        return f"a number from {self.low:g} to {self.high:g}{unit}"


class Imperfection:
    """One imperfection; the class is never instantiated, its docstring is its description."""

    NAME: ClassVar[str]
    NUMBERS: ClassVar[tuple[Number, ...]]
    PER_JOINT: ClassVar[bool]
    NEEDS: ClassVar[str] = ""  # another imperfection without which this one would do nothing

    @classmethod
    def summary(cls) -> str:
        """The first line of the description, without its full stop."""
        return (cls.__doc__ or "").splitlines()[0].removesuffix(".")

    @classmethod
    def unit(cls) -> str:
        """The unit of its number, the words to choose from, or how many numbers it has."""
        if len(cls.NUMBERS) > 1:
            return f"{len(cls.NUMBERS)} numbers"
        return " or ".join(cls.NUMBERS[0].words) or cls.NUMBERS[0].unit

    @classmethod
    def defaults(cls, joints: int) -> tuple[float, ...]:
        """The values where it is not given: one per joint, or one per number."""
        return tuple(n.default for n in cls.NUMBERS) * (joints if cls.PER_JOINT else 1)

    @classmethod
    def read(cls, values: Sequence[object], joints: int) -> tuple[float, ...]:
        """One value per joint, or one per number; a ValueError says what is wrong."""
        numbers = cls.NUMBERS * joints if cls.PER_JOINT else cls.NUMBERS
        if cls.PER_JOINT and len(values) == 1:
            values = list(values) * joints
        if len(values) != len(numbers):
            raise ValueError(f"{_count(len(values), 'value')}; give {cls._wanted(joints)}")
        return tuple(number.read(x) for x, number in zip(values, numbers, strict=True))

    @classmethod
    def _wanted(cls, joints: int) -> str:
        if cls.PER_JOINT:
            return f"one for all joints, or one for each of {_count(joints, 'joint')}"
        if len(cls.NUMBERS) == 1:
            return "one"
        return f"{len(cls.NUMBERS)} ({', '.join(number.what for number in cls.NUMBERS)})"


class PerJoint(Imperfection):
    """An imperfection of every joint: one value for all joints, or one per joint."""

    PER_JOINT = True


class OfTheRobot(Imperfection):
    """An imperfection of the whole robot or of its log."""

    PER_JOINT = False


def _count(n: int, what: str) -> str:
    return f"{n} {what}{'' if n == 1 else 's'}"
