"""Alternatives to the model: columns that are fitted beside it, and rows that are left out.

A bias matters as far as it moves the estimates. Therefore the estimation is repeated with
alternatives to what it takes for granted. Those of this module concern the torques: that friction
has no offset, asymmetry or Stribeck effect and does not depend on the load or the position, that
nothing else pulls on the joints, that gravity acts as described, and that the logged torques are
proportional to the real ones. Those of parallel.py concern the positions and their derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from scarid_cli.algorithms.regression.rows import Rows, predicted, runs
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.robots.terms import Mass, Term
from scarid_cli.algorithms.statistics.ripple import gain
from scarid_cli.arrays import Array, Marks

OFFSET, ASYMMETRY, LOAD, SPRING = "offset", "asymmetry", "load", "spring"
SATURATION, DRIFT, TILT, GAIN = "saturation", "drift", "tilt", "gain"
GEOMETRY = "geometry"
RIPPLE, SINE, COSINE = "ripple", "ripple as a sine", "ripple as a cosine"
UNEVEN, UNEVEN_SINE, UNEVEN_COSINE = (
    "uneven friction",
    "uneven friction as a sine",
    "uneven friction as a cosine",
)
# Alternatives that are a sine and a cosine of each joint, whose phase is not known.
WAVES = {RIPPLE: (SINE, COSINE), UNEVEN: (UNEVEN_SINE, UNEVEN_COSINE)}
# A cable pulls as a spring does, and more than in proportion where it is bent far.
CABLE, CUBE = "cable", "cable as a cube"
# Alternatives that are fitted as several shapes.
PARTS = {**WAVES, CABLE: (SPRING, CUBE)}
SLOW, STRIBECK, CURVATURE = "slow friction", "Stribeck", "curvature"
# Of the root-mean-square velocity: where the friction of slow motion has decayed. Together the
# three are a curve of friction over the speed.
DECAYED = {SLOW: 0.1, STRIBECK: 0.3, CURVATURE: 1.0}
TORQUES = (
    OFFSET,
    ASYMMETRY,
    *DECAYED,
    LOAD,
    SPRING,
    CABLE,
    SATURATION,
    DRIFT,
    TILT,
    GAIN,
    RIPPLE,
    UNEVEN,
    GEOMETRY,
)
TURN = 0.5 * np.pi  # rad: over less, what varies over a turn cannot be told from what does not
WINDOW = 0.2  # s: length of the Hann window that smooths all signals
BESIDE_FRICTION = (
    "offset",
    "stribeck",
    "quadratic",
)  # beside friction


def hann(h: float) -> Array:
    """The taps of the window for rows that are h [s] apart; their sum is 1."""
    taps = np.hanning(2 * round(0.5 * WINDOW / h) + 3)[1:-1] if h > 0.0 else np.ones(1)
    return np.asarray(taps / taps.sum())


@dataclass(frozen=True)
class Model:
    """The robot whose regressor the rows have, and the indices of the columns that were kept."""

    robot: Robot
    kept: list[int]

    def regressor(self, q: Array, dq: Array, ddq: Array) -> Array:
        """W of the kept columns (samples, joints, parameters)."""
        return self.robot.regressor(q, dq, ddq)[:, :, self.kept]

    def inertias(self, q: Array) -> Array:
        """The rows (joints, samples, parameters) of the diagonal of the inertia matrix at q.

        q (joints, samples).
        """
        rest = np.zeros_like(q)
        still = self.regressor(q, rest, rest)
        units = np.broadcast_to(np.eye(len(q))[:, :, None], (len(q), *q.shape))
        moved = (self.regressor(q, rest, np.ascontiguousarray(ddq)) for ddq in units)
        return np.stack([(x - still)[:, j] for j, x in enumerate(moved)])

    @property
    def transmits(self) -> Marks:
        """Which of the kept parameters are of torques that a joint transmits: all but friction."""
        return self._marks(transmitted)

    def link_torques(self, motion: Array, theta: Array) -> Array:
        """The torques (samples, joints) of the links alone, without friction and motors.

        motion (3, joints, samples): positions, velocities and accelerations.
        """
        links = self.transmits & self._marks(lambda term: not isinstance(term, Mass))
        kept = [i for i, chosen in zip(self.kept, links, strict=True) if chosen]
        return self.robot.partial_torques(motion, kept, theta[links])

    def tilted(self, q: Array, theta: Array) -> Array | None:
        """The gravity torques (samples, joints, 2) of a base that is tilted about two axes, by 1.

        q (joints, samples). None without a URDF or without gravity.
        """
        body = self.robot.body
        if not body or not any(body.gravity):
            return None
        still = np.stack((q, np.zeros_like(q), np.zeros_like(q)))
        sideways = _sideways(np.array(body.gravity))
        robots = [replace(self.robot, body=replace(body, gravity=tuple(g))) for g in sideways]
        torques = [replace(self, robot=r).link_torques(still, theta) for r in robots]
        return np.stack(torques, axis=2)

    def leaning(self, q: Array, theta: Array, sines: Array) -> Array | None:
        """The columns (samples, joints, 4) of a base that leans: `tilted`, and two of joint 1.

        Times the `sines` (2) of the angles, the first two are what leaning adds to the torques,
        what it takes from the weight included. Where the axis of joint 1 is vertical, no parameter
        has the first moments of what it turns, which pull at it when it leans. Where it is not,
        parameters have the other two columns already.
        """
        torques = self.tilted(q, theta)
        if torques is None:
            return None
        if square := float(np.sum(sines**2)):
            still = np.stack((q, np.zeros_like(q), np.zeros_like(q)))
            part = (np.sqrt(max(1.0 - square, 0.0)) - 1.0) / square
            torques = torques + part * sines * self.link_torques(still, theta)[:, :, None]
        found = np.concatenate((torques, np.zeros_like(torques)), axis=2)
        if self.robot.joints[0].unit == "rad":
            found[:, 0, 2], found[:, 0, 3] = np.cos(q[0]), np.sin(q[0])
        return found

    def _marks(self, chosen: Callable[[Term], bool]) -> Marks:
        return np.array([chosen(self.robot.parameters[i].term) for i in self.kept], dtype=bool)


def tilted(gravity: Array, amounts: Array) -> Array:
    """The gravity [m/s2] of a base that leans by angles of these sines (2).

    An amount of nan, about an axis about which the log shows no tilt, is none.
    """
    sines = np.nan_to_num(amounts)
    left = np.sqrt(max(1.0 - float(sines @ sines), 0.0))
    return np.asarray(left * gravity + sines @ _sideways(gravity))


def _sideways(gravity: Array) -> Array:
    """Two vectors (2, 3) as long as that of gravity, at right angles to it and to each other."""
    return np.asarray(np.linalg.svd(gravity[None])[2][1:] * np.linalg.norm(gravity))


def transmitted(term: Term) -> bool:
    """Whether a joint transmits the torques of this term: it is no friction, nor goes with it."""
    return not (term.NEVER_NEGATIVE or term.NAME in BESIDE_FRICTION)


@dataclass(frozen=True)
class Signals:
    """What torques beyond the model depend on, each (samples, joints).

    `q`, `v` and `time` [s] from the start; `predicted` are the torques of the model, `transmitted`
    those of it that pass through the gears, 0 without a model. `turns` (joints) is whether a joint
    turns by a good part of a turn. `usual` (joints) are the speeds
    by which velocities are scaled, `cycles` (joints) the periods of ripple per rad or m, and
    `passed` what the low-pass behind the rows leaves of a frequency [Hz].
    """

    q: Array
    v: Array
    time: Array
    predicted: Array
    transmitted: Array
    turns: Marks
    usual: Array
    cycles: Array
    passed: Callable[[Array], Array]

    @classmethod
    def of(cls, rows: Rows, model: Model | None, estimates: Array) -> Signals:
        """Those of the rows, at estimates of the first columns of W, without ripple.

        The usual speeds are the root mean squares of these rows.
        """
        q, v = rows.motion[0].T, rows.motion[1].T
        time = np.broadcast_to(rows.h * (rows.at - rows.at[0])[:, None], v.shape)
        usual = np.sqrt(np.mean(v**2, axis=0)) + 1e-300
        own = np.flatnonzero(model.transmits) if model else np.empty(0, dtype=np.int64)
        torques = predicted(rows, estimates), rows.W[:, :, own] @ estimates[own]
        turns = turning(rows, model)
        return cls(q, v, time, *torques, turns, usual, np.zeros(v.shape[1]), partial(gain, rows))

    def friction(self, decayed: float) -> Array:
        """Friction that has decayed at this part of the usual speed."""
        return np.asarray(np.sign(self.v) * np.exp(-((self.v / (decayed * self.usual)) ** 2)))

    def ripple(self, wave: Callable[[Array], Array]) -> Array:
        """What is left of a sine or cosine; 0 where there is no ripple."""
        left = self.passed(self.cycles * self.v) * wave(2.0 * np.pi * self.cycles * self.q)
        return np.asarray(left * (self.cycles > 0.0))


def turning(rows: Rows, model: Model | None) -> Marks:
    """Whether each joint turns by more than TURN (joints)."""
    far = np.ptp(rows.motion[0], axis=1) > TURN
    units = [joint.unit for joint in model.robot.joints] if model else ["rad"] * len(far)
    return np.asarray(far & (np.array(units) == "rad"))


SHAPES: dict[str, Callable[[Signals], Array]] = {
    OFFSET: lambda x: np.ones_like(x.v),
    ASYMMETRY: lambda x: np.abs(x.v),
    SLOW: lambda x: x.friction(DECAYED[SLOW]),
    STRIBECK: lambda x: x.friction(DECAYED[STRIBECK]),
    CURVATURE: lambda x: x.friction(DECAYED[CURVATURE]),
    SPRING: lambda x: x.q,
    CUBE: lambda x: x.q**3,
    SATURATION: lambda x: x.predicted * np.abs(x.predicted),
    DRIFT: lambda x: x.time - x.time.mean(axis=0),
    GAIN: lambda x: x.predicted,  # what joints have in common says how their torques fit together
    # Friction of gears grows with the torque that they transmit, which only a model can tell.
    LOAD: lambda x: np.sign(x.v) * np.abs(x.transmitted),
    SINE: lambda x: x.ripple(np.sin),
    COSINE: lambda x: x.ripple(np.cos),
    # Coulomb friction that varies over a turn, as of gears that are not round.
    UNEVEN_SINE: lambda x: np.sign(x.v) * np.sin(x.q) * x.turns,
    UNEVEN_COSINE: lambda x: np.sign(x.v) * np.cos(x.q) * x.turns,
}


def torque_columns(
    rows: Rows,
    model: Model | None,
    estimates: Array,
    cycles: Array,
    apart: Collection[int] = (),
) -> dict[str, Array]:
    """Further columns (samples, joints, columns) of each alternative for the torques.

    `cycles` (ripples, joints) are the periods of ripple per rad or m, 0 where there is none. Gains
    of the joints (from 0) that are `apart` are among the estimates.
    """
    signals = Signals.of(rows, model, estimates)
    shapes = {name: shape for name, shape in SHAPES.items() if model or name != LOAD}
    waves = [shapes.pop(name) for name in WAVES[RIPPLE]]
    uneven = [diagonal(shapes.pop(name)(signals)) for name in WAVES[UNEVEN]]
    columns = {name: diagonal(shape(signals)) for name, shape in shapes.items()}
    columns[GAIN] *= compared(rows, estimates, apart)
    columns[SPRING] = np.concatenate((columns[OFFSET], columns[SPRING]), axis=2)
    columns[CABLE] = np.concatenate((columns[SPRING], columns.pop(CUBE)), axis=2)
    ripples = [replace(signals, cycles=own) for own in cycles]
    if ripples:
        parts = [diagonal(wave(ripple)) for ripple in ripples for wave in waves]
        columns[RIPPLE] = np.concatenate(parts, axis=2)
    columns[UNEVEN] = np.concatenate(uneven, axis=2)
    upright = np.zeros(2)
    own = estimates[: len(model.kept)] if model else estimates
    tilt = model.leaning(rows.motion[0], own, upright) if model else None
    if tilt is not None:
        columns[TILT] = tilt
    return columns


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


def away_from_reversals(rows: Rows, within: float = 0.5 * WINDOW) -> Array:
    """The scales of the rows, 0 `within` this time [s] of a reversal or of a row left out."""
    half = max(1, round(within / rows.h)) if rows.h > 0.0 else 1
    scales = np.zeros_like(rows.scales)
    for run in runs(rows.at):
        direction = np.sign(rows.motion[1][:, run].T) * (rows.scales[run] > 0.0)
        scales[run] = rows.scales[run] * _constant(direction, half)
    return scales


def _constant(x: Array, half: int) -> Array:
    """Whether x (samples, joints) is the same, and not 0, in a window around each sample."""
    samples = len(x)
    changes = (x == 0.0).astype(np.int64)
    changes[1:] += x[1:] != x[:-1]
    sums = np.concatenate((np.zeros((1, x.shape[1]), dtype=np.int64), np.cumsum(changes, axis=0)))
    at = np.arange(samples)
    inside = (at >= half) & (at < samples - half)
    end, start = np.minimum(at + half + 1, samples), np.maximum(at - half, 0)
    still: Array = (sums[end] - sums[start] == 0) & inside[:, None]
    return still
