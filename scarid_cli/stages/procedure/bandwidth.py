"""One bandwidth for all joints of a robot, and the settings that give it to differentiators."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite, log2, nan
from typing import Any

import numpy as np

from scarid_cli.algorithms.checks.finding import joints_text
from scarid_cli.algorithms.choices.registry import DIFFERENTIATORS
from scarid_cli.algorithms.filters.likelihood import noise_floor
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.tuning.equivalent import chain, equivalent, typed
from scarid_cli.algorithms.tuning.lead import without_lead
from scarid_cli.algorithms.tuning.lowpassed import END, ORDER, Segment, removed
from scarid_cli.algorithms.tuning.scatter import Choice, Scatter, chosen, curve, lowest
from scarid_cli.algorithms.tuning.search import Trial
from scarid_cli.algorithms.tuning.spread import spread
from scarid_cli.errors import BadData
from scarid_cli.stages.records.record import Record
from scarid_cli.stages.tune import BANDWIDTH, SCATTER, Progress, Tried, nearest

CHOICES = 3  # at most, each without the lead of the torques behind the cut-off of the one before
FEWEST = 100  # rows: a shorter log says little about which joints move
STILL = 10.0  # standard deviations of its noise within which a joint rests
SEEN = 1.0  # Hz: the spectrum of a long log is that of blocks of 20 s
NEAR = 0.1  # octaves between two cut-offs that count as the same


@dataclass(frozen=True)
class Bandwidth:
    """The cut-off [Hz] of all joints, its plateau [Hz], and what was found at each cut-off.

    `noise` [rad or m] is the standard deviation of what the low-pass takes from the positions.
    """

    choice: Choice
    points: tuple[Scatter, ...]
    noise: float

    @property
    def point(self) -> Scatter:
        """The scatter at the cut-off that was chosen."""
        return next(p for p in self.points if p.cutoff == self.choice.cutoff)

    @property
    def cutoff(self) -> float:
        """The cut-off [Hz] in four digits, as it is typed."""
        return typed(self.choice.cutoff)

    @property
    def text(self) -> str:
        """The choice in a line."""
        low, high = self.choice.plateau
        where = f"from {low:.3g} to {high:.3g} Hz" if high > low else "there"
        share = 100.0 * self.point.share
        return (
            f"cut-off {self.choice.cutoff:.3g} Hz for all joints: the estimates agree best "
            f"{where}; {share:.0f} % of the rows count"
        )


def bandwidth(record: Record, robot: Robot, progress: Progress = lambda: None) -> Bandwidth:
    """The cut-off at which estimates of the parameters of this robot agree best."""
    segments = record.segments
    some, _ = spread(segments, record.h, SEEN)
    sample, share = spread(segments, record.h, lowest(robot, some, record.h))
    points = curve(robot, sample, record.h, progress, share)
    if not _known(points):
        raise _too_few(record, robot)
    for _ in range(CHOICES):
        before = chosen(points).cutoff
        steady = without_lead(robot, sample, record.h, before)
        again = curve(robot, steady, record.h, progress, share) if steady else []
        points = again if _known(again) else points
        if not again or abs(log2(chosen(points).cutoff / before)) < NEAR:
            break
    choice = chosen(points)
    return Bandwidth(choice, tuple(points), _noise(segments, record.h, choice.cutoff))


def _too_few(record: Record, robot: Robot) -> BadData:
    """Why no bandwidth can be chosen: joints that do not move, or too short a log."""
    segments = record.segments
    low = np.min([s.q.min(axis=1) for s in segments], axis=0)
    high = np.max([s.q.max(axis=1) for s in segments], axis=0)
    noise = np.max([s.noise for s in segments], axis=0)
    still = (np.flatnonzero(high - low < STILL * noise) + 1).tolist()
    if still and sum(s.q.shape[1] for s in segments) >= FEWEST:
        return BadData(
            f"{record.name}: {joints_text(still)} {'does' if len(still) == 1 else 'do'} not move; "
            "give a log in which every joint moves, or fix these joints in the description and "
            "give their columns other names (`scarid convert --map held=q2 --map q2=q3`)"
        )
    return BadData(
        f"{record.name}: too few rows are away from reversals and standstill to choose a "
        f"bandwidth for the {len(robot.parameters)} parameters of {robot.name}; give a longer "
        "log, in which every joint moves"
    )


def _known(points: Sequence[Scatter]) -> bool:
    """Whether the rows determine the parameters at any cut-off."""
    return any(isfinite(point.scatter) for point in points)


def _noise(segments: Sequence[Segment], h: float, cutoff: float) -> float:
    """What the low-pass takes from the positions (rms), at least what their resolution makes.

    Of a long log it is that of blocks, whose ends do not count.
    """
    some, share = spread(segments, h, cutoff)
    ends = int(END / cutoff / h) if share < 1.0 else 0
    rest = [removed(segment, h, cutoff) for segment in some]
    inner = np.concatenate([x[:, ends : x.shape[1] - ends] for x in rest], axis=1)
    floors = [noise_floor(list(segment.q)) for segment in some]
    return max(float(np.sqrt(np.mean(inner**2))), *floors)


def tune_for(
    record: Record, found: Bandwidth, names: Sequence[str], seed: int, progress: Progress
) -> Iterator[Tried]:
    """The trials of the bandwidth, and for each method the settings that have this bandwidth."""
    for point in found.points:
        zero_phase = DIFFERENTIATORS.load("zero-phase")(cutoff=typed(point.cutoff), order=ORDER)
        best = point.cutoff == found.choice.cutoff
        yield Tried("zero-phase", SCATTER, Trial(zero_phase, point.scatter), best, point.rows)
    for name in names:
        method = DIFFERENTIATORS.load(name)()
        same = equivalent(method, found.noise, found.cutoff, record.h)
        if same is not None:
            yield Tried(name, BANDWIDTH, Trial(same, nan), best=True)
            continue
        smoother = recommended(found, record.h)
        smoothers = [smoother] * record.joints
        yield from nearest(name, method, record, smoothers, seed, progress)


def recommended(found: Bandwidth, h: float) -> Any:
    """The smoother of the recommended procedure, with this bandwidth."""
    return _smoother(found.noise, found.cutoff, h)


def smoother_at(record: Record, cutoff: float) -> Any:
    """The smoother of the recommended procedure for a record, with this cut-off [Hz]."""
    return _smoother(_noise(record.segments, record.h, cutoff), typed(cutoff), record.h)


def _smoother(noise: float, cutoff: float, h: float) -> Any:
    return chain(DIFFERENTIATORS.load("rts")(), noise, cutoff, h)
