"""Which moving joints of a URDF are the axes of a serial arm; all others are locked.

The axes are the moving joints on the way from the base to the tip:

- Where the way branches, it goes on with the branch that has more moving joints than all the other
  branches together. The fingers of a hand are no such branch, so the arm ends at the hand.
- A single last joint beyond the tool frame (a massless link, fixed to the link before that joint)
  moves the jaw of a gripper and is no axis.
- A joint with a <mimic> is driven by another joint and is no axis. It moves with it where the way
  to the tip leads through it, and where it is the only joint after the last axis.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

LOST = "is modelled as locked"  # of a joint that moves


@dataclass(frozen=True)
class Chain:
    """The names of the axes from the base to the tip, and why each other joint is locked.

    `followers` are the joints of the chain that move with an axis, and which axis that is.
    """

    axes: tuple[str, ...]
    locked: dict[str, str]
    followers: dict[str, str] = field(default_factory=dict)


def serial(
    names: Sequence[str],
    parents: Sequence[int],
    drivers: Mapping[str, str],
    frames: Collection[int] = (),
) -> Chain:
    """The chain of a tree of moving joints, numbered from 1; the base is 0.

    `parents` has the number of the moving joint before each one, `drivers` the joint that each
    joint with a <mimic> follows, `frames` the joints whose links carry a massless frame.
    """
    children: dict[int, list[int]] = {number: [] for number in range(len(names) + 1)}
    for number, parent in enumerate(parents, start=1):
        children[parent].append(number)
    way = _way(children)
    why = "where the joints branch and the arm ends"
    if len(way) > 2 and not children[way[-1]] and way[-1] not in frames and way[-2] in frames:
        way.pop()
        why = "whose link carries the tool frame"
    axes = tuple(names[number - 1] for number in way[1:] if names[number - 1] not in drivers)
    beyond = _beyond(children, way[-1])
    followers = {
        name: driver
        for name in (names[number - 1] for number in way[1:])
        if (driver := _driver(name, drivers)) in axes and name in drivers
    }
    locked = {}
    for number, name in enumerate(names, start=1):
        if name in axes or name in followers:
            continue
        if name in drivers:
            locked[name] = _follows(drivers[name], axes)
        elif number in beyond:
            locked[name] = f"beyond {names[way[-1] - 1]}, {why}"
        else:
            locked[name] = "on a side branch of the arm"
    return Chain(axes, locked, followers)


def named(
    names: Sequence[str],
    parents: Sequence[int],
    drivers: Mapping[str, str],
    wanted: Sequence[str],
) -> Chain:
    """The chain of the joints that a description names, and of those that follow them there."""
    followers = {}
    for name in _line(names, parents, drivers, wanted):
        driver = _driver(name, {k: d for k, d in drivers.items() if k not in wanted})
        if name not in wanted and driver in wanted:
            followers[name] = driver
    locked = {}
    for name in names:
        if name not in wanted and name not in followers:
            driver = drivers.get(name, "")
            locked[name] = (
                _follows(driver, wanted) if driver in wanted else "not named in the description"
            )
    return Chain(tuple(wanted), locked, followers)


def _line(
    names: Sequence[str],
    parents: Sequence[int],
    drivers: Mapping[str, str],
    wanted: Sequence[str],
) -> list[str]:
    """The joints on the way to the last axis, and those after it as long as one alone follows."""
    number = names.index(wanted[-1]) + 1
    line = [number]
    while parents[line[0] - 1]:
        line.insert(0, parents[line[0] - 1])
    while True:
        after = [k for k, parent in enumerate(parents, start=1) if parent == line[-1]]
        if len(after) != 1 or names[after[0] - 1] not in drivers:
            return [names[k - 1] for k in line]
        line.append(after[0])


def _driver(name: str, drivers: Mapping[str, str]) -> str:
    """The joint that a joint follows in the end: that of a joint that follows none is itself."""
    seen = {name}
    while name in drivers and drivers[name] not in seen:
        name = drivers[name]
        seen.add(name)
    return name


def _way(children: Mapping[int, list[int]]) -> list[int]:
    """The joints from the base to the point where no branch outweighs the others."""
    way = [0]
    while True:
        sizes = {child: 1 + len(_beyond(children, child)) for child in children[way[-1]]}
        most = max(sizes, key=lambda child: sizes[child], default=None)
        if most is None or 2 * sizes[most] <= sum(sizes.values()):
            return way
        way.append(most)


def _beyond(children: Mapping[int, list[int]], place: int) -> set[int]:
    """All moving joints that a joint carries."""
    found = set(children[place])
    for child in children[place]:
        found |= _beyond(children, child)
    return found


def _follows(driver: str, axes: Sequence[str]) -> str:
    if driver in axes:
        return f"mimics {driver}, an axis, but {LOST}"
    return f"mimics {driver}"
