"""Leaps in a signal that no motion makes: wraps of an angle or a counter, and single glitches.

A reading that wraps goes back by its modulus: a turn of an angle, the range of a counter. A glitch
is one reading far from those beside it. Both stand out: without them, no reading differs from the
mean of the two beside it by a small part as much.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from scarid_cli.arrays import Array, Marks, Numbers

# What wraps: a turn in rad and in degrees, half and quarter turns of some encoders, and counters.
TURNS = (2.0 * pi, 360.0, pi, 180.0, 1.0)
COUNTERS = tuple(2.0**bits for bits in (8, 10, 12, 13, 14, 16, 17, 18, 19, 20, 24, 32))
OUT = 8.0  # times the largest difference of a reading from those beside it that is none of a leap
SHARE = 0.02  # of the readings at most that are leaps: more are a coarse clock
SAME = 0.1  # of a modulus that only the leaps show: by which the reach may be larger
NEAR = 0.02  # of a known modulus: by which that of the leaps may differ to be this one
FEWEST = 16  # readings


@dataclass(frozen=True)
class Leaps:
    """The leaps of a signal: the readings before which it wraps, by its `modulus`, and glitches.

    `wraps` and `glitches` are rows; `turns` says by how many moduli each wrap goes forward.
    """

    wraps: Numbers
    turns: Numbers
    modulus: float
    glitches: Numbers

    def unwrapped(self, x: Array) -> Array:
        """The signal without its wraps."""
        steps = np.zeros(len(x))
        steps[self.wraps] = self.turns
        return np.asarray(x - self.modulus * np.cumsum(steps))

    def without_glitches(self, x: Array) -> Array:
        """The signal with nan for each glitch."""
        x = x.copy()
        x[self.glitches] = np.nan
        return x


NONE = Leaps(*(np.empty(0, dtype=np.int64),) * 2, 0.0, np.empty(0, dtype=np.int64))


def leaps_of(x: Array) -> Leaps:
    """The leaps of a signal (rows), which may have nan for what is missing."""
    rows = np.flatnonzero(np.isfinite(x))
    if len(rows) < FEWEST:
        return NONE
    values = x[rows]
    found = _glitches(values)
    kept = np.flatnonzero(~found)
    wraps, turns, modulus = _wraps(values[kept])
    if not len(wraps):  # wraps that return at once look like glitches
        every, there, size = _wraps(values)
        if len(every) and _known(size):
            return Leaps(rows[every], there, size, NONE.glitches)
    return Leaps(rows[kept[wraps]], turns, modulus, rows[found])


def _bends(x: Array) -> Array:
    """How far each reading but the ends is from the mean of the two beside it."""
    return np.asarray(np.abs(x[1:-1] - 0.5 * (x[:-2] + x[2:])))


def _glitches(x: Array) -> Marks:
    """Which readings are far from both beside them, which are near to each other."""
    found = np.zeros(len(x), dtype=bool)
    bends = _bends(x)
    alone = bends > OUT * 0.5 * np.abs(x[2:] - x[:-2])
    left, chosen = bends.copy(), np.zeros(len(bends), dtype=bool)
    for _ in range(int(SHARE * len(x))):
        top = int(np.argmax(left))
        if not alone[top]:
            break
        chosen[top] = True
        left[max(0, top - 1) : top + 2] = 0.0  # a glitch bends the readings beside it as well
        rest = left.max(initial=0.0)
        if rest > 0.0 and bends[chosen].min() > OUT * rest:
            found[1:-1] = chosen
            break
    return found


def _wraps(x: Array) -> tuple[Numbers, Numbers, float]:
    """The readings before which the signal leaps by a modulus, by how many, and the modulus."""
    steps = np.diff(x)
    reach = float(np.ptp(x))
    leaps = np.flatnonzero(np.abs(steps) > 0.5 * reach)
    none = (NONE.wraps, NONE.turns, 0.0)
    if not len(leaps) or len(leaps) > max(1.0, SHARE * len(x)) or not reach > 0.0:
        return none
    usual = np.delete(steps, leaps)
    modulus = _modulus(steps[leaps], usual)
    fastest = float(np.abs(usual).max(initial=0.0))
    slack = 2.0 * fastest + 1e-9 * modulus if _known(modulus) else SAME * modulus
    if not modulus or reach > modulus + slack:
        return none
    off = np.abs(np.abs(steps[leaps]) - modulus)
    if np.any(off > 2.0 * fastest + 1e-9 * modulus) or modulus < OUT * fastest:
        return none
    return leaps + 1, np.sign(steps[leaps]).astype(np.int64), modulus


def _modulus(leaps: Array, usual: Array) -> float:
    """The modulus of these leaps: a known one that is near, else their median if several."""
    size = float(np.median(np.abs(leaps)))
    slack = NEAR * size + 2.0 * float(np.abs(usual).max(initial=0.0))
    near = [known for known in (*TURNS, *COUNTERS) if abs(size - known) <= slack]
    if near:
        return min(near, key=lambda known: abs(size - known))
    return size if len(leaps) > 1 else 0.0


def _known(modulus: float) -> bool:
    return modulus in TURNS or modulus in COUNTERS
