"""What the torques of a log clearly are beyond the model, fitted beside the parameters.

If one alternative (alternatives.py) explains nearly all that the torques are beyond the model, it
is fitted with it: friction that grows with the load, for example, would otherwise make masses
larger. It is no parameter, because the robot has no such term, but goes with them where torques
are predicted.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from statistics import fmean

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.statistics.alternatives import (
    CABLE,
    DRIFT,
    GAIN,
    LOAD,
    OFFSET,
    PARTS,
    RIPPLE,
    SHAPES,
    SPRING,
    TILT,
    Model,
    Signals,
)
from scarid_cli.algorithms.statistics.explanations import Explanation
from scarid_cli.algorithms.statistics.mismatches import (
    MISMATCHES,
    Mismatches,
)
from scarid_cli.arrays import Array

REFITS = 4  # gains of .6 are then as large at the next fit, to a tenth of their errors
COMPARED = (GAIN, OFFSET, TILT)  # a comparison of logs has columns for these by itself
# Whose columns depend on the estimates beside them, so that they are fitted again.
RELATIVE = (GAIN, TILT)


@dataclass(frozen=True)
class Addition:
    """A torque of a joint (from 0): `size` times one of the SHAPES, whose name it has.

    A tilt of the base is that of all joints, and has a column of it in place of the joint.

    `usual` [rad/s or m/s] is the speed by which the shape scales velocities, and `cycles` the
    periods of a ripple per rad or m, 0 for others. `error` is the standard error of the size. A
    mismatch of a joint (mismatches.py) changes the torques of others as well.
    """

    name: str
    joint: int
    usual: float
    size: float = np.nan
    cycles: float = 0.0
    error: float = field(default=np.nan, compare=False)

    @property
    def mismatch(self) -> bool:
        """Whether it is a late signal or a joint that yields."""
        return self.name in MISMATCHES

    @property
    def lasts(self) -> bool:
        """Whether it belongs to the robot, and not to one log."""
        return self.name != DRIFT

    @property
    def possible(self) -> bool:
        """Whether there is such a thing: friction takes a part of the load away.

        What yields does so in the direction of the torque, and what is late is not early.
        """
        if self.mismatch:
            return self.size > 0.0
        return self.name != LOAD or 0.0 < self.size < 1.0


def of_explanation(
    explanation: Explanation, rows: Rows, constant: Collection[int]
) -> tuple[Addition, ...]:
    """The additions of an explanation. The joints that are `constant` have an offset already.

    A spring is slack somewhere, so that it takes an offset.
    """
    usual = np.sqrt(np.mean(rows.motion[1] ** 2, axis=1))
    found = explanation.torques
    slack = {(OFFSET, j) for name, j in found if name in (SPRING, CABLE) and j not in constant}
    parts = {
        (wave, j, float(cycles))
        for name, j in found
        if name in PARTS
        for cycles in (explanation.cycles[:, j] if name == RIPPLE else [0.0])
        if cycles > 0.0 or name != RIPPLE
        for wave in PARTS[name]
    }
    plain = {(name, j, 0.0) for name, j in found | slack if name not in PARTS}
    return tuple(
        Addition(name, j, 1.0 if name == TILT else float(usual[j]), cycles=cycles)
        for name, j, cycles in sorted(plain | parts)
    )


def gains(additions: Sequence[Addition], joints: int) -> Array:
    """The gains of the torques (joints) that were fitted, 1 where none was."""
    found = np.ones(joints)
    for addition in additions:
        found[addition.joint] += addition.size if addition.name == GAIN else 0.0
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


@dataclass(frozen=True)
class Shapes:
    """The shapes of additions, as they are with the parameters `theta` of the model."""

    additions: Sequence[Addition]
    model: Model
    theta: Array

    @property
    def possible(self) -> bool:
        """Whether there are additions of these sizes."""
        return all(addition.possible for addition in self.additions)

    @property
    def curved(self) -> bool:
        """Whether a column depends on the size that it gets."""
        return any(addition.mismatch for addition in self.additions)

    @property
    def refits(self) -> int:
        """The fits until columns that depend on the estimates beside them no longer change."""
        return REFITS if self.curved or any(x.name in RELATIVE for x in self.additions) else 1

    @property
    def constant(self) -> list[int]:
        """The joints (from 0) that have an offset."""
        return [addition.joint for addition in self.additions if addition.name == OFFSET]

    def beside(self, rows: Rows) -> Rows:
        """The rows with the shapes as further columns."""
        return replace(rows, W=np.concatenate((rows.W, self.columns(rows)), axis=2))

    def compared(self, rows: Rows) -> Rows:
        """The rows as logs are compared: without their gains, beside what no comparison fits."""
        others = [addition for addition in self.additions if addition.name not in COMPARED]
        wide = replace(self, additions=others).beside(rows) if others else rows
        tilts = replace(self, additions=[x for x in self.additions if x.name == TILT])
        y = wide.y - tilts.torques(rows) if tilts.additions else wide.y
        return replace(wide, y=y / gains(self.additions, wide.y.shape[1]))

    def columns(self, rows: Rows) -> Array:
        """The shapes (samples, joints, additions)."""
        signals = Signals.of(rows, self.model, self.theta)
        columns = np.zeros((*rows.y.shape, len(self.additions)))
        joints = np.ones(rows.y.shape[1])
        mismatches = Mismatches(rows, self.model, self.theta)
        signals = replace(signals, turns=joints > 0.0)  # those of the log that shows them
        tilted = self._tilted(rows)
        for k, addition in enumerate(self.additions):
            usual, cycles = addition.usual * joints, addition.cycles * joints
            if addition.mismatch:
                of = addition.name, addition.joint, addition.size
                columns[:, :, k] = mismatches.column(*of)
                continue
            if addition.name == TILT:
                columns[:, :, k] = 0.0 if tilted is None else tilted[:, :, addition.joint]
                continue
            own = replace(signals, usual=usual, cycles=cycles)
            columns[:, addition.joint, k] = SHAPES[addition.name](own)[:, addition.joint]
        return columns

    def _tilted(self, rows: Rows) -> Array | None:
        """The columns of a base that is tilted, if it is; None without gravity."""
        own = [addition for addition in self.additions if addition.name == TILT]
        if not own:
            return None
        sines = np.zeros(2)
        for addition in own:
            if addition.joint < len(sines):
                sines[addition.joint] = np.nan_to_num(addition.size)  # before the first fit
        return self.model.leaning(rows.motion[0], self.theta, sines)

    def torques(self, rows: Rows) -> Array:
        """The torques (samples, joints) of the additions that belong to the robot."""
        sizes = [addition.size if addition.lasts else 0.0 for addition in self.additions]
        return np.asarray(self.columns(rows) @ np.array(sizes))

    def sized(self, sizes: Array) -> tuple[Addition, ...]:
        """The additions, with the first of these sizes."""
        pairs = zip(self.additions, sizes.tolist(), strict=False)
        return tuple(replace(addition, size=size) for addition, size in pairs)
