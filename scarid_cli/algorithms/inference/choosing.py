"""Friction chosen by the data: `scarid identify --friction auto`.

Candidates are the shapes of friction beyond the model (beyond/torques.py), each for each joint,
beside what `identify` fits anyway. One after another is added, the best one first, while it lowers
the error of parts of the log that are left out of the fit by more than the uncertainty of this.
Then those that the others have made superfluous are dropped. Coulomb friction that differs between
the directions is an offset of the torque while the joint moves. The error is the mean logarithm
over the parts, as a few parts hold most of the squares. Its uncertainty has Student's t, with a
level that is divided by the number of candidates (Bonferroni): more of them do not make anything
appear useful.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from scarid_cli.algorithms.beyond.additions import Addition
from scarid_cli.algorithms.beyond.catalogue import SHAPES
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.signals import turning
from scarid_cli.algorithms.beyond.torques import Offset, Ripple, Uneven
from scarid_cli.algorithms.effects.additions import Shapes
from scarid_cli.algorithms.inference.consequences import held_out_squares
from scarid_cli.algorithms.regression.rows import Rows, thinned
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.jackknife import quantile
from scarid_cli.arrays import Array

# Of each joint; offsets are there already.
FRICTION = [name for name, kind in SHAPES.items() if kind.FRICTION and name != Offset.NAME]
PARTS = 20  # of the log, each left out once
LEVEL = 0.05  # of choosing anything where there is nothing
REFITS = 3  # times that the joints are weighted by their residuals


@dataclass(frozen=True)
class Worth:
    """What a shape of friction of a joint (from 1) is worth.

    `lower` [%] is by how much it lowers the root-mean-square error of parts that were left out (as
    a geometric mean), and `half_interval` [%] half the 95 % interval of this. It was `kept`,
    or would be the next one.
    """

    name: str
    joint: int
    lower: float
    half_interval: float
    kept: bool

    @property
    def extra(self) -> dict[str, Any]:
        return asdict(self)


@dataclass(frozen=True)
class Candidate:
    """A shape of a joint (from 0), as one or two additions; `at` are its columns."""

    name: str
    joint: int
    additions: tuple[Addition, ...]
    at: tuple[int, ...]


def friction(
    rows: Rows,
    model: Model,
    theta: Array,
    cycles: Array,
    fitted: Sequence[Addition],
    offsets: Sequence[int],
) -> tuple[tuple[Addition, ...], list[Worth]]:
    """The shapes of friction that are worth it, and what each is worth.

    `theta` are the estimates of the first columns of W, the robot's; others are fitted as well,
    first the additions that are `fitted` already, then the `offsets` of joints (from 0).
    `cycles` (ripples, joints) are the periods of the likeliest ripples per rad or m.
    """
    rows = thinned(rows)
    there = {(x.name, x.joint) for x in fitted}
    there |= {(Uneven.PARTS[0].NAME, j) for j in np.flatnonzero(~turning(rows, model)).tolist()}
    further = list(_candidates(rows, cycles, rows.W.shape[2], there))
    additions = [addition for each in further for addition in each.additions]
    wide = Shapes(additions, model, theta).beside(rows)
    first = len(theta) + len(fitted)
    constant = [
        Candidate(Offset.NAME, j, (Addition(Offset.NAME, j, 1.0),), (k,))
        for k, j in enumerate(offsets, start=first)
    ]
    candidates = [*constant, *further]
    given = [k for k in range(rows.W.shape[2]) if not first <= k < first + len(offsets)]
    trial = _Trial(Blocks.every(wide.h).add(wide).whole(), given, len(candidates))
    kept = trial.chosen(candidates)
    worths = [trial.worth(each, [x for x in kept if x is not each], kept=True) for each in kept]
    added = tuple(x for each in kept for x in each.additions)
    return added, [*worths, *trial.others(candidates, kept)]


def _candidates(
    rows: Rows, cycles: Array, first: int, there: set[tuple[str, int]]
) -> Iterator[Candidate]:
    """All candidates that are not `there`, whose columns begin at the `first`."""
    usual = np.sqrt(np.mean(rows.motion[1] ** 2, axis=1)).tolist()
    for j, speed in enumerate(usual):
        for name in (name for name in FRICTION if (name, j) not in there):
            yield Candidate(name, j, (Addition(name, j, speed),), (first,))
            first += 1
        pair = tuple(Addition(part.NAME, j, speed) for part in Uneven.PARTS)
        if (pair[0].name, j) not in there:
            yield Candidate(Uneven.NAME, j, pair, (first, first + 1))
            first += 2
        ripples = (
            [] if (Ripple.PARTS[0].NAME, j) in there else cycles[:, j][cycles[:, j] > 0.0].tolist()
        )
        for own in ripples:
            pair = tuple(Addition(part.NAME, j, speed, cycles=own) for part in Ripple.PARTS)
            yield Candidate(Ripple.NAME, j, pair, (first, first + 1))
            first += 2


class _Trial:
    """The errors of parts that are left out, of sets of candidates."""

    def __init__(self, blocks: Blocks, given: list[int], count: int) -> None:
        """The `given` columns of the blocks always belong to the fit."""
        self._blocks, self._given = blocks, given
        self._weights = self._by_residuals()
        self._factor = quantile(1.0 - 0.5 * LEVEL / max(count, 1), PARTS - 1.0)
        self._known: dict[tuple[int, ...], Array] = {}

    def _by_residuals(self) -> Array:
        """The weights of the joints: the inverse of their residuals, without any candidate."""
        total = self._blocks.columns(self._given).total
        weights = np.ones(len(total))
        for _ in range(REFITS):
            whole = np.tensordot(weights**2, total, 1)
            theta = np.linalg.lstsq(whole[:-2, :-2], whole[:-2, -2], rcond=None)[0]
            along = np.concatenate((-theta, [1.0, 0.0]))
            squares = np.einsum("i,jik,k->j", along, total, along)
            weights = 1.0 / np.sqrt(np.maximum(squares / np.maximum(total[:, -1, -1], 1), 1e-300))
        return np.asarray(weights)

    def errors(self, kept: Sequence[Candidate]) -> Array:
        """The logarithm of the weighted residual of each part that was left out (parts)."""
        columns = tuple(sorted(k for each in kept for k in each.at))
        if columns not in self._known:
            blocks = self._blocks.columns([*self._given, *columns])
            squares = held_out_squares(blocks, self._weights, parts=PARTS)
            self._known[columns] = 0.5 * np.log(squares @ self._weights**2)
        return self._known[columns]

    def gain(self, one: Candidate, beside: Sequence[Candidate]) -> tuple[float, float]:
        """By how much it lowers the logarithm, beside others, and the standard error of this."""
        before, after = self.errors(beside), self.errors([*beside, one])
        if not np.isfinite(after).all():
            return -np.inf, 0.0
        parts = before - after
        return float(parts.mean()), float(parts.std(ddof=1) / np.sqrt(len(parts)))

    def worthwhile(self, one: Candidate, beside: Sequence[Candidate]) -> bool:
        """Whether it lowers the error by more than the uncertainty."""
        lower, error = self.gain(one, beside)
        return lower > self._factor * error

    def chosen(self, candidates: Sequence[Candidate]) -> list[Candidate]:
        """Those that are worth it: the best one added first, the superfluous ones dropped."""
        kept: list[Candidate] = []
        while rest := [x for x in candidates if x not in kept and self.worthwhile(x, kept)]:
            kept.append(max(rest, key=lambda x: self.gain(x, kept)[0]))
        for one in reversed(kept.copy()):
            beside = [x for x in kept if x is not one]
            if not self.worthwhile(one, beside):
                kept = beside
        return kept

    def worth(self, one: Candidate, beside: Sequence[Candidate], *, kept: bool) -> Worth:
        """In percent of the root mean square."""
        lower, error = self.gain(one, beside)
        left = float(np.exp(-lower))
        half = quantile(0.975, PARTS - 1.0) * error * left
        return Worth(one.name, one.joint + 1, 100.0 * (1.0 - left), 100.0 * half, kept)

    def others(self, candidates: Sequence[Candidate], kept: Sequence[Candidate]) -> Iterator[Worth]:
        """Of each shape that no joint has, the joint where it is worth most."""
        there = {each.name for each in kept}
        for name in dict.fromkeys(x.name for x in candidates):
            own = [x for x in candidates if x.name == name]
            if name not in there and own:
                best = max(own, key=lambda x: self.gain(x, kept)[0])
                if np.isfinite(self.gain(best, kept)[0]):
                    yield self.worth(best, kept, kept=False)
