"""Something beyond the model that was fitted beside the parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from statistics import fmean

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import MISMATCHES, SHAPES, SINGLE, Entry
from scarid_cli.algorithms.beyond.signals import Signals
from scarid_cli.algorithms.beyond.torques import RelativeGain
from scarid_cli.arrays import Array


@dataclass(frozen=True)
class Addition:
    """A torque of a joint (from 0): `size` times the shape of an entry, whose name it has.

    A tilt of the base is that of all joints, and has a column of it in place of the joint.

    `usual` [rad/s or m/s] is the speed by which the shape scales velocities, and `cycles` the
    periods of a ripple per rad or m, 0 for others. `error` is the standard error of the size. A
    mismatch of a joint (gears.py) changes the torques of others as well.
    """

    name: str
    joint: int
    usual: float
    size: float = np.nan
    cycles: float = 0.0
    error: float = field(default=np.nan, compare=False)

    @property
    def entry(self) -> Entry:
        """Its entry of the catalogue."""
        return SINGLE[self.name]

    def of(self, signals: Signals) -> Array:
        """Its shape (samples, joints), with the speed and the ripple that it has for all joints."""
        joints = np.ones(len(signals.usual))
        usual, ripples = self.usual * joints, self.cycles * joints[None]
        return SHAPES[self.name].shape(replace(signals, usual=usual, ripples=ripples))

    @property
    def mismatch(self) -> bool:
        """Whether it is a late signal or a joint that yields."""
        return self.name in MISMATCHES

    @property
    def lasts(self) -> bool:
        """Whether it belongs to the robot, and not to one log."""
        return self.entry.LASTS

    @property
    def possible(self) -> bool:
        """Whether there is such a thing."""
        return self.entry.possible(self.size)


def gains(additions: Sequence[Addition], joints: int) -> Array:
    """The gains of the torques (joints) that were fitted, 1 where none was."""
    found = np.ones(joints)
    for gain in (x for x in additions if x.name == RelativeGain.NAME):
        found[gain.joint] += gain.size
    return found


def mean_additions(sets: Sequence[Sequence[Addition]]) -> tuple[Addition, ...]:
    """The mean of several sets of additions, of which each may have others."""
    alike: dict[tuple[str, int, float], list[Addition]] = {}
    for addition in chain.from_iterable(sets):
        alike.setdefault((addition.name, addition.joint, addition.cycles), []).append(addition)
    return tuple(
        replace(
            own[0],
            usual=fmean(x.usual for x in own),
            size=sum(x.size for x in own) / len(sets),
            error=float(np.linalg.norm([x.error for x in own])) / len(sets),
        )
        for own in alike.values()
    )
