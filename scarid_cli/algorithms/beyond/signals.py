"""What the entries for torques depend on: the motion, the torques of the model, the low-pass."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import partial

import numpy as np

from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.ripple import gain
from scarid_cli.algorithms.regression.rows import Rows, predicted
from scarid_cli.arrays import Array, Marks

TURN = 0.5 * np.pi  # rad: over less, what varies over a turn cannot be told from what does not


@dataclass(frozen=True)
class Signals:
    """What torques beyond the model depend on, each (samples, joints).

    `q`, `v` and `time` [s] from the start; `predicted` are the torques of the model, `transmitted`
    those of it that pass through the gears, and `rubbing` those of friction, 0 without a model.
    `turns` (joints) is whether a joint turns by a good part of a turn. `usual` (joints) are the
    speeds by which velocities are scaled, `ripples` (ripples, joints) the periods of each ripple
    per rad or m, 0 where there is none, and `passed` what the low-pass behind the rows leaves of a
    frequency [Hz]. `others` (joints) is 1 for a joint whose torque others can be compared with. The
    `model` has the parameters `theta`; `motion` (3, joints, samples) has the accelerations, too.
    """

    q: Array
    v: Array
    time: Array
    predicted: Array
    transmitted: Array
    rubbing: Array
    turns: Marks
    usual: Array
    ripples: Array
    passed: Callable[[Array], Array]
    others: Array
    model: Model | None
    theta: Array
    motion: Array

    @classmethod
    def of(cls, rows: Rows, model: Model | None, estimates: Array) -> Signals:
        """Those of the rows, at estimates of the first columns of W.

        The usual speeds are the root mean squares of these rows. There is no ripple, and all joints
        are compared.
        """
        q, v = rows.motion[0].T, rows.motion[1].T
        time = np.broadcast_to(rows.h * (rows.at - rows.at[0])[:, None], v.shape)
        usual = np.sqrt(np.mean(v**2, axis=0)) + 1e-300
        none = np.empty(0, dtype=np.int64)
        kept = [np.flatnonzero(x) for x in (model.transmits, model.rubs)] if model else [none, none]
        transmitted, rubbing = (rows.W[:, :, own] @ estimates[own] for own in kept)
        return cls(
            q=q,
            v=v,
            time=time,
            predicted=predicted(rows, estimates),
            transmitted=transmitted,
            rubbing=rubbing,
            turns=turning(rows, model),
            usual=usual,
            ripples=np.zeros((0, v.shape[1])),
            passed=partial(gain, rows),
            others=np.ones(v.shape[1]),
            model=model,
            theta=estimates[: len(model.kept)] if model else estimates,
            motion=rows.motion[:3],
        )

    def friction(self, decayed: float) -> Array:
        """Friction that has decayed at this part of the usual speed."""
        return np.asarray(np.sign(self.v) * np.exp(-((self.v / (decayed * self.usual)) ** 2)))

    def ripple(self, wave: Callable[[Array], Array]) -> Array:
        """What is left of a sine or cosine of the one ripple; 0 where there is none."""
        (cycles,) = self.ripples
        left = self.passed(cycles * self.v) * wave(2.0 * np.pi * cycles * self.q)
        return np.asarray(left * (cycles > 0.0))


def turning(rows: Rows, model: Model | None) -> Marks:
    """Whether each joint turns by more than TURN (joints)."""
    far = np.ptp(rows.motion[0], axis=1) > TURN
    units = [joint.unit for joint in model.robot.joints] if model else ["rad"] * len(far)
    return np.asarray(far & (np.array(units) == "rad"))


def compared(rows: Rows, estimates: Array, apart: Collection[int] = ()) -> Array:
    """1 for each joint whose torque others can be compared with (joints), but for one of them.

    Joints are compared by the parameters that they share. The one with the largest torque of those
    is what the others are compared with: a common factor cannot be told. Joints that are `apart`
    (from 0), because their gains are estimated, are none of them.
    """
    power = _shared(rows, estimates, apart)
    marks: Array = np.asarray(power > 0.0, dtype=np.float64)
    marks[int(np.argmax(power))] = 0.0
    return marks


def reference(rows: Rows, estimates: Array, apart: Collection[int] = ()) -> int:
    """The joint (from 0) with whose torque those of the others are `compared`."""
    return int(np.argmax(_shared(rows, estimates, apart)))


def _shared(rows: Rows, estimates: Array, apart: Collection[int]) -> Array:
    """The squares of the torques (joints) of the parameters that joints share; 0 if `apart`."""
    W = rows.W[:, :, : len(estimates)]
    shared = np.count_nonzero(np.any(W != 0.0, axis=0), axis=0) > 1
    power = np.asarray(np.sum((W[:, :, shared] @ estimates[shared]) ** 2, axis=0))
    power[list(apart)] = 0.0
    return power


def diagonal(values: Array) -> Array:
    """One column for each joint (samples, joints, joints), from its values (samples, joints)."""
    columns = np.zeros((*values.shape, values.shape[1]))
    each = np.arange(values.shape[1])
    columns[:, each, each] = values
    return columns
