"""Checks of the values of a robot description; the message of an error names the value."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from math import isfinite
from typing import Any

from scarid_cli.algorithms.keys.lines import UnknownKey

MOST_JOINTS = 100  # that a robot may have: beyond, its regressor takes minutes and gigabytes


def moderate(joints: int) -> None:
    """Refuse a robot with more than MOST_JOINTS joints."""
    if joints > MOST_JOINTS:
        raise ValueError(f"it has {joints} moving joints; at most {MOST_JOINTS} are supported")


def text(key: str, value: Any) -> str:
    """A string that is not empty."""
    if not isinstance(value, str) or not value:
        raise TypeError(f"{key} is {value!r}, not a string")
    return value


def number(key: str, value: Any) -> float:
    """A finite number."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        raise TypeError(f"{key} is {value!r}, not a number")
    if abs(value) > 1e300 or not isfinite(value):
        raise ValueError(f"{key} is not a finite number")
    return float(value)


def whole(key: str, value: Any) -> int:
    """A whole number."""
    if not isinstance(value, int) or isinstance(value, bool):
        raise TypeError(f"{key} is {value!r}, not a whole number")
    return value


def row(key: str, value: Any, length: int) -> tuple[float, ...]:
    """A list of this many numbers."""
    if not isinstance(value, list) or len(value) != length:
        raise TypeError(f"{key} is {value!r}, not a list of {length} numbers")
    return tuple(number(key, x) for x in value)


def table(key: str, value: Any) -> dict[str, Any]:
    """A table of the file, [key]."""
    if not isinstance(value, dict):
        raise TypeError(f"{key} is {value!r}, not a table")
    return value


def tables(key: str, value: Any) -> list[dict[str, Any]]:
    """An array of tables of the file, [[key]]."""
    if not isinstance(value, list):
        raise TypeError(f"{key} is {value!r}, not tables [[{key}]]")
    return [table(key, entry) for entry in value]


def choice(key: str, value: Any, known: Collection[str]) -> str:
    """One of the known words."""
    if value not in known:
        raise ValueError(f"{key} {value!r}; choose {' or '.join(known)}")
    return str(value)


def only(what: str, entry: dict[str, Any], known: Collection[str]) -> None:
    """Refuses a table with any other key than the known ones."""
    for key in entry:
        if key not in known:
            raise UnknownKey(what, key, list(known))


def distinct(what: str, values: list[Any]) -> None:
    """Refuses a list in which a value appears twice."""
    twice = next((value for value, count in Counter(values).items() if count > 1), None)
    if twice is not None:
        raise ValueError(f"the {what} {twice!r} appears twice")
