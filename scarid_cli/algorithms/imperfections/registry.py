"""All imperfections by name, and the values that a user gave them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any

from scarid_cli.algorithms.imperfections import positions, robot, rows, torques
from scarid_cli.algorithms.imperfections.declared import Imperfection
from scarid_cli.algorithms.keys.values import table

# Where they act, as headings of the help and of the documentation.
PLACES = {
    "Robot": robot,
    "Measured position": positions,
    "Logged torque": torques,
    "Rows and clock": rows,
}


def declared_in(place: str) -> list[type[Imperfection]]:
    """The imperfections of a place, in the order of its module."""
    module = PLACES[place]
    own = (x for x in vars(module).values() if getattr(x, "__module__", "") == module.__name__)
    return [x for x in own if isinstance(x, type) and issubclass(x, Imperfection)]


IMPERFECTIONS = {kind.NAME: kind for place in PLACES for kind in declared_in(place)}


@dataclass(frozen=True)
class Imperfections:
    """The values that were given, by name, for a robot with so many joints."""

    joints: int
    given: Mapping[str, tuple[float, ...]] = field(default_factory=dict)

    def of(self, kind: type[Imperfection]) -> tuple[float, ...]:
        """The values of an imperfection: one per joint, or one per number."""
        return self.given.get(kind.NAME, kind.defaults(self.joints))

    def one(self, kind: type[Imperfection]) -> float:
        """The value of an imperfection of the whole robot that has one number."""
        (value,) = self.of(kind)
        return value

    def has(self, kind: type[Imperfection]) -> bool:
        """Whether the user gave this imperfection."""
        return kind.NAME in self.given

    def check(self) -> None:
        """Refuse an imperfection that would do nothing; a ValueError says what is missing."""
        for name in self.given:
            needed = IMPERFECTIONS[name].NEEDS
            if needed and needed not in self.given:
                raise ValueError(f"{name} has no effect without {needed}; give both")


def values_of(name: str, values: Sequence[object], joints: int) -> tuple[float, ...]:
    """The checked values of the imperfection of this name; a ValueError says what is wrong."""
    if name not in IMPERFECTIONS:
        near = get_close_matches(name, IMPERFECTIONS, 3)
        hint = f"did you mean {' or '.join(near)}?" if near else "scarid simulate --help lists all"
        raise ValueError(f"there is no imperfection {name!r}; {hint}")
    return IMPERFECTIONS[name].read(values, joints)


def imperfections_of(document: dict[str, Any], joints: int) -> dict[str, tuple[float, ...]]:
    """The values of [imperfections] of a robot description; none if it has no such table."""
    given = {}
    for name, value in table("imperfections", document.get("imperfections", {})).items():
        try:
            given[name] = values_of(name, value if isinstance(value, list) else [value], joints)
        except ValueError as error:
            raise ValueError(f"[imperfections] {name}: {error}") from None
    return given


def written(name: str, values: Sequence[float]) -> str:
    """An imperfection as --with takes it, with its unit."""
    kind = IMPERFECTIONS[name]
    numbers = kind.NUMBERS * len(values) if kind.PER_JOINT else kind.NUMBERS
    text = ",".join(n.write(x) for n, x in zip(numbers, values, strict=True))
    unit = kind.NUMBERS[0].unit if len(kind.NUMBERS) == 1 else ""
    return f"{name}={text} {unit}".strip()
