"""A reference that is held before and after its motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from scarid_cli.algorithms.trajectories.hermite import Motion

PART = 4096  # ticks at a time, so that a long standstill needs no more memory than a short one

Timed = tuple[float, Motion]  # the time of the first tick of all [s], and some ticks


def with_standstill(references: Iterator[Timed], before: int, after: int) -> Iterator[Timed]:
    """The references, with so many ticks at rest at the first and at the last position."""
    last: Timed | None = None
    for start, motion in references:
        if last is None:
            yield from _rest(start, motion, 0, before)
        last = start, motion
        yield last
    if last is not None:
        yield from _rest(*last, -1, after)


def _rest(start: float, motion: Motion, place: int, ticks: int) -> Iterator[Timed]:
    position = motion[0][:, [place]]
    for first in range(0, ticks, PART):
        q = np.repeat(position, min(PART, ticks - first), axis=1)
        yield start, (q, np.zeros_like(q), np.zeros_like(q))
