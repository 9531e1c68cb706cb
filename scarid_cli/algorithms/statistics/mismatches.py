"""Columns of what may lie between a log and its robot: signals, gears and friction with a memory.

The position of one joint or its torque may be older than the other signals, a gear yields by the
torque that it carries or has a gap, and friction and torques may depend on where they came from.
Where one of these explains what the torques are beyond the model, it is fitted beside the
parameters (additions.py). With its size s the torques become

    late position    tau(q_j(t + s))                          [s]
    late torque      tau_j(t - s)                             [s]
    elastic gear     tau_links(q_j - s tau_t)                 [rad/(N m)], encoder on the motor
    backlash         tau_links(q_j - s sign(tau_t))           [rad], half the gap, likewise
    elastic joint    tau_j + s d2(tau_t)/dt2                  [s2], encoder on the link
    hysteresis       play of tau_j by s                       [N m]
    presliding       Coulomb friction times (q_j - play of q_j by s) / s in place of sign(dq_j)
                                                              [rad], half the distance

where tau_t is the torque that the joint transmits, and a play follows a signal at a distance of at
most s. What jumps passes the low-pass of the rows. They are not linear in s: a column is the secant
(tau(s) - tau(0)) / s at a size that is known already, or else at a small one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from scarid_cli.algorithms.filters.two_sided import two_sided_taps
from scarid_cli.algorithms.regression.rows import Rows, curvature, delay_column, runs, slope
from scarid_cli.algorithms.statistics.alternatives import Model
from scarid_cli.algorithms.statistics.ringing import LowPass
from scarid_cli.arrays import Array

LATE_POSITION, LATE_TORQUE = "late position", "late torque"
ELASTIC_GEAR, ELASTIC_JOINT = "elastic gear", "elastic joint"
BACKLASH, HYSTERESIS, PRESLIDING = "backlash", "hysteresis", "presliding"
MISMATCHES = (
    LATE_POSITION,
    LATE_TORQUE,
    ELASTIC_GEAR,
    ELASTIC_JOINT,
    BACKLASH,
    HYSTERESIS,
    PRESLIDING,
)
# Sizes that are small for any robot.
SMALL = {LATE_POSITION: 1e-4, ELASTIC_GEAR: 1e-6, BACKLASH: 1e-4, PRESLIDING: 1e-2}
YIELDS = 2  # times that the torque is computed where the joint has yielded: more amplify noise
DERIVATIVES = 2 * YIELDS  # samples on either side that these need
MEMORY = 1.0  # s: no row depends on those that are farther away than what jumps and what plays need
WIDESPREAD = (BACKLASH, HYSTERESIS, PRESLIDING)  # what one gear or sensor has, others may have
PLAYS, JUMPS = (HYSTERESIS, PRESLIDING), (BACKLASH, HYSTERESIS, PRESLIDING)


def reach(name: str, h: float) -> int:
    """The samples on either side, h [s] apart, that the column of a mismatch depends on."""
    seconds = MEMORY * ((name in PLAYS) + (name in JUMPS))
    return DERIVATIVES + (int(np.ceil(seconds / h)) if h > 0.0 else 0)


@dataclass(frozen=True)
class Mismatches:
    """The columns of mismatches beside W, whose first columns are those of the model.

    Its parameters are `theta`.
    """

    rows: Rows
    model: Model
    theta: Array

    def column(self, name: str, joint: int, size: float = np.nan) -> Array:
        """That of a joint (from 0), per unit of its size (samples, joints).

        `size` is where the secant ends, nan if that is not known.
        """
        own = {
            LATE_POSITION: self._late_position,
            LATE_TORQUE: self._late_torque,
            ELASTIC_GEAR: self._elastic_gear,
            ELASTIC_JOINT: self._elastic_joint,
            BACKLASH: self._backlash,
            HYSTERESIS: self._hysteresis,
            PRESLIDING: self._presliding,
        }
        return own[name](joint, SMALL.get(name, 0.0) if np.isnan(size) else size)

    def _late_position(self, joint: int, s: float) -> Array:
        q, dq, ddq = self.rows.motion[:3, joint]
        jerk = slope(self.rows, ddq)
        later = np.stack((
            q + s * dq + 0.5 * s**2 * ddq,
            dq + s * ddq + 0.5 * s**2 * jerk,
            ddq + s * jerk + 0.5 * s**2 * slope(self.rows, jerk),
        ))  # fmt: skip
        column = (self._torques(joint, later) - self._links) / s
        rest = self._predicted(joint) - self._links[:, joint]  # friction and motor
        column[:, joint] += _delay(self.rows, joint, rest, s)
        return column

    def _late_torque(self, joint: int, s: float) -> Array:
        return self._own(joint, -_delay(self.rows, joint, self._predicted(joint), -s))

    def _elastic_gear(self, joint: int, s: float) -> Array:
        torques = self._links
        for _ in range(1 if s == SMALL[ELASTIC_GEAR] else YIELDS):
            torques = self._behind(joint, s * torques[:, joint])
        return np.asarray((torques - self._links) / s)

    def _elastic_joint(self, joint: int, _: float) -> Array:
        return self._own(joint, _of_joint(self.rows, joint, self._links[:, joint], curvature))

    def _backlash(self, joint: int, s: float) -> Array:
        side = self._passed(np.sign(self._links[:, joint]))
        return np.asarray((self._behind(joint, s * side) - self._links) / s)

    def _hysteresis(self, joint: int, s: float) -> Array:
        torque = self._predicted(joint)
        if not s:
            return self._own(joint, self._passed(-np.sign(slope(self.rows, torque))))
        return self._own(joint, self._passed((played(self.rows, torque, s) - torque) / s))

    def _presliding(self, joint: int, s: float) -> Array:
        q, dq = self.rows.motion[:2, joint]
        share = (q - played(self.rows, q, s)) / s - np.sign(dq)
        return self._own(joint, self._passed(self._coulomb(joint) * share / s))

    def _coulomb(self, joint: int) -> float:
        """The Coulomb friction of a joint, 0 without this term."""
        terms = [self.model.robot.parameters[i].term for i in self.model.kept]
        own = [term.NAME == "coulomb" and term.joints == (joint + 1,) for term in terms]
        return float(np.sum(self.theta[own]))

    def _predicted(self, joint: int) -> Array:
        """All torques of a joint (samples)."""
        return np.asarray(self.rows.W[:, joint, : len(self.theta)] @ self.theta)

    def _own(self, joint: int, torque: Array) -> Array:
        """The column (samples, joints) of a torque of this joint alone."""
        column = np.zeros_like(self.rows.y)
        column[:, joint] = torque
        return column

    def _passed(self, x: Array) -> Array:
        """A signal (samples) behind the low-pass of the rows, if this is known."""
        rows = self.rows
        low_pass = LowPass.behind(rows)
        if low_pass is None:
            return x
        taps = two_sided_taps(low_pass.cutoff, low_pass.order, int(MEMORY / rows.h))
        half, found = len(taps) // 2, np.empty_like(x)
        for run in runs(rows.at):
            found[run] = np.convolve(np.pad(x[run], half, mode="edge"), taps, "valid")
        return found

    @cached_property
    def _links(self) -> Array:
        """The torques (samples, joints) of the links."""
        return self._of(self.rows.motion[:3])

    def _behind(self, joint: int, distance: Array) -> Array:
        """Those with the link of a joint so far behind its encoder (samples)."""
        speed = slope(self.rows, distance)
        yielded = np.stack((distance, speed, slope(self.rows, speed)))
        return self._torques(joint, self.rows.motion[:3, joint] - yielded)

    def _torques(self, joint: int, own: Array) -> Array:
        """Those with another motion (3, samples) of a joint."""
        motion = self.rows.motion[:3].copy()
        motion[:, joint] = own
        return self._of(motion)

    def _of(self, motion: Array) -> Array:
        return self.model.link_torques(np.ascontiguousarray(motion), self.theta)


def played(rows: Rows, x: Array, size: float) -> Array:
    """The play of a signal (samples): it follows at a distance of at most `size`.

    It knows the signal of the last MEMORY only, so that no row depends on those long before it.
    """
    steps = int(MEMORY / rows.h) if rows.h > 0.0 else 0
    found = np.empty_like(x)
    for run in runs(rows.at):
        count = run.stop - run.start
        around = np.pad(x[run], (steps, 0), mode="edge")
        now = around[:count]
        for k in range(1, steps + 1):
            here = around[k : k + count]
            now = np.clip(now, here - size, here + size)
        found[run] = now
    return found


def _delay(rows: Rows, joint: int, torque: Array, s: float) -> Array:
    """(torque(t + s) - torque(t)) / s of a joint, to second order; 0 where it reverses."""
    first = _of_joint(rows, joint, torque, delay_column)
    return first + 0.5 * s * _of_joint(rows, joint, torque, curvature)


def _of_joint(
    rows: Rows, joint: int, torque: Array, derivative: Callable[[Rows, Array], Array]
) -> Array:
    torques = np.zeros_like(rows.y)
    torques[:, joint] = torque
    return np.asarray(derivative(rows, torques)[:, joint])
