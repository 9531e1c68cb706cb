"""Positions that jump: readings that were lost for a while, or two logs one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from scarid_cli.algorithms.checks.log import Log
from scarid_cli.algorithms.processes.resolution import resolution_of
from scarid_cli.arrays import Array

FEWEST = 16  # readings
MOST = 8  # jumps of a joint: more are how it moves, or a coarse clock
OUT = 5.0  # times the speed of all other intervals: no motion has one that stands out so far
STEPS = 10.0  # times the resolution of the positions


@dataclass(frozen=True)
class Jump:
    """A jump of the position of a joint (from 0) before row `start`, and back before row `end`.

    `value` is the position in between, if this never changes; else there is no `end`.
    """

    joint: int
    start: int
    end: int | None = None
    value: float = 0.0


def jumped(log: Log) -> list[Jump]:
    """The jumps of the positions of a log without wraps and glitches."""
    return [jump for j, q in enumerate(log.q) for jump in _paired(j, q, _rows(log.t, q))]


def _rows(t: Array, q: Array) -> list[int]:
    """The rows (from 0) before which a position jumps."""
    known = np.flatnonzero(np.isfinite(t) & np.isfinite(q))
    if len(known) < FEWEST:
        return []
    steps, seconds = np.abs(np.diff(q[known])), np.diff(t[known])
    speeds = np.divide(steps, seconds, out=np.zeros_like(steps), where=seconds > 0.0)
    few = np.argpartition(speeds, -(MOST + 1))[-(MOST + 1) :]
    order = few[np.argsort(speeds[few])[::-1]]
    fastest = speeds[order]
    apart = (fastest[:-1] > OUT * fastest[1:]) & (fastest[1:] > 0.0)
    if not apart.any():
        return []
    chosen = order[: int(np.argmax(apart)) + 1]
    far = chosen[steps[chosen] > STEPS * resolution_of(q[known])]
    return sorted((known[far + 1]).tolist())


def _paired(joint: int, q: Array, rows: list[int]) -> Iterator[Jump]:
    """The jumps before these rows, those to a value that never changes together with the return."""
    left = rows.copy()
    while left:
        start = left.pop(0)
        if left and np.ptp(q[start : left[0]]) == 0.0:
            yield Jump(joint, start, left.pop(0), float(q[start]))
        else:
            yield Jump(joint, start)


def without(log: Log, jumps: list[Jump]) -> Log:
    """The log in segments between jumps, without the positions that never change."""
    if not jumps:
        return log
    q = log.q.copy()
    segment = np.zeros(log.rows) if log.segment is None else np.array(log.segment, np.float64)
    for jump in jumps:
        if jump.end is None:
            segment[jump.start :] += 1.0
        else:
            q[jump.joint, jump.start : jump.end] = np.nan
    return replace(log, q=q, segment=segment)


def told(jumps: list[Jump], joints: int, rows: int) -> Mapping[str, str]:
    """What jumps and where, each with what to do about it."""
    found = {}
    for jump in jumps:
        name, first = f"q{jump.joint + 1}", jump.start + 1
        if jump.end is not None:
            text = f"{name} is {jump.value:.6g} in rows {first} to {jump.end}"
            found[text] = (
                f"readings that were lost? Leave them out: --rows {_longest(jump, rows)} is the "
                "longest part without them"
            )
    alone = [jump for jump in jumps if jump.end is None]
    for start in dict.fromkeys(jump.start for jump in alone):
        own = [jump.joint for jump in alone if jump.start == start]
        names = "all positions" if len(own) == joints > 1 else ", ".join(f"q{j + 1}" for j in own)
        verb = "jump" if len(own) > 1 else "jumps"
        text = f"{names} {verb} before row {start + 1}"
        found[text] = (
            f"two logs one after the other? --rows 1:{start} and --rows {start + 1}:{rows} are one "
            "each"
        )
    return found


def _longest(jump: Jump, rows: int) -> str:
    assert jump.end is not None
    return f"1:{jump.start}" if jump.start > rows - jump.end else f"{jump.end + 1}:{rows}"
