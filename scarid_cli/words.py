"""Lists, joints and parts in sentences."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

EACH = 3  # joints, of which each figure has its own label at most


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
