"""How far each alternative to the model moves the estimates, and whether that is significant."""

from __future__ import annotations

from collections.abc import Collection, Sequence, Set
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from scarid_cli.algorithms.beyond.catalogue import (
    MISMATCHES,
    PHENOMENA,
    TORQUES,
    WIDESPREAD,
)
from scarid_cli.algorithms.beyond.gears import Gears, Presliding
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.ripple import Ripples
from scarid_cli.algorithms.beyond.rows import Parallel, Reversals
from scarid_cli.algorithms.beyond.signals import Signals, compared, diagonal, reference
from scarid_cli.algorithms.beyond.torques import Curvature, Offset, RelativeGain, Ripple
from scarid_cli.algorithms.effects.parallel import smoothed
from scarid_cli.algorithms.regression.rows import Rows, thinned
from scarid_cli.algorithms.regression.whitening import ColouredNoise
from scarid_cli.algorithms.uncertainty.autocovariance import autocovariance_errors
from scarid_cli.algorithms.uncertainty.cuts import Cut, cuts
from scarid_cli.algorithms.uncertainty.jackknife import block_numbers, quantile
from scarid_cli.algorithms.uncertainty.products import Products, Solved, jackknifed
from scarid_cli.algorithms.uncertainty.reversals import away_from_reversals
from scarid_cli.arrays import Array, Numbers

FINER = (0.1, 0.17, 0.3, 0.55, 1.0)  # speeds of DECAYED, and others between them
BLOCKS = 5.0  # effective ones, below which the error of the size of slow friction is not known
CERTAIN = 0.01  # probability of calling an effect significant that is none
TRUST = 1.5  # variances of an effect that are subtracted from its square


@dataclass(frozen=True)
class Effect:
    """How far the estimates move under an alternative, and the errors of that (parameters).

    `apart` is how far they move because of the alternative alone, on rows that are otherwise
    treated alike. `amounts` are the statistics that show whether there is an effect, with their
    `noise`, from so many `blocks`: the estimates of the further columns of an alternative (nan for
    those that are not in it), or else how far the parameters move. One that is `suspected` counts
    whether it is significant or not. One that is `shared` was fitted for other joints, so that
    these may have it as far as the log can tell. It is the best of so many that were `searched`.
    `told` is the entry as which it is told, if not its own.
    """

    name: str
    moved: Array
    errors: Array
    apart: Array
    amounts: Array
    noise: Array
    blocks: int
    suspected: bool = False
    shared: bool = False
    searched: float = 1.0
    told: str = ""

    @cached_property
    def ratios(self) -> Array:
        """The amounts in units of their noise; 0 where there is none."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.nan_to_num(np.abs(self.amounts) / self.noise, posinf=0.0))

    @property
    def largest(self) -> float:
        """The largest of the ratios."""
        return float(np.max(self.ratios, initial=0.0))

    @property
    def tests(self) -> float:
        """The number of amounts that were tested."""
        return self.searched * np.count_nonzero(~np.isnan(self.amounts))

    def threshold(self, level: float = CERTAIN) -> float:
        """The ratio that noise alone exceeds with this probability in any of the tests."""
        return quantile(1.0 - 0.5 * level / max(self.tests, 1), self.blocks - 1)

    def clearness(self, level: float) -> float:
        """The largest ratio, divided by the one that noise exceeds with this probability."""
        return self.largest / self.threshold(level)

    def significant(self, level: float = CERTAIN) -> bool:
        """Whether noise would have such an effect with less than this probability."""
        return self.largest > self.threshold(level)

    def joints(self, level: float, count: int) -> list[int]:
        """The joints (from 0), of so many, of which a column is significant."""
        there = np.flatnonzero(self.ratios > self.threshold(level))
        return sorted({k % count for k in there.tolist()})

    @property
    def counts(self) -> bool:
        """Whether the intervals allow for it."""
        always = self.suspected or self.shared or PHENOMENA[self.name].ALWAYS
        return always or self.significant()

    @property
    def widespread(self) -> bool:
        """Whether all joints are likely to have what some have, as zeros of one calibration."""
        return self.shared or (PHENOMENA[self.name].TOGETHER and self.significant())

    @property
    def _trust(self) -> float:
        """The variances that are subtracted from the square of the move."""
        return -1.0 if self.widespread else TRUST

    @property
    def bias(self) -> Array:
        """The part of the move that its error does not explain (parameters); 0 if there is none.

        Of one that is widespread it is the move and its error: what others have is no chance.
        """
        if not self.counts:
            return np.zeros_like(self.moved)
        rest = self.moved**2 - self._trust * self.errors**2
        return np.asarray(np.sign(self.moved) * np.sqrt(np.maximum(np.nan_to_num(rest), 0.0)))

    def direction(self, scatter: Array) -> Array:
        """The bias of all estimates together (parameters), for their covariance.

        It keeps the direction of the move, in which large moves of single parameters may cancel in
        the torque. `scatter` (parameters) are the errors from noise, which make them comparable.
        """
        if not self.counts:
            return np.zeros_like(self.moved)
        known = scatter > 0.0
        squares = float(np.sum((self.moved[known] / scatter[known]) ** 2))
        noise = self._trust * float(np.sum((self.errors[known] / scatter[known]) ** 2))
        share: float = max(1.0 - noise / squares, 0.0) if squares > 0.0 else 0.0
        return np.asarray(share**0.5 * self.moved, dtype=np.float64)


def of_known_size(name: str, moved: Array) -> Effect:
    """The effect (parameters) of something whose size is known, so that it always counts."""
    none = np.zeros_like(moved)
    return Effect(name, moved, none, moved, amounts=none, noise=none, blocks=2, suspected=True)


def level_among(effects: Sequence[Effect]) -> float:
    """The level of significance of one of so many, of which any is by chance more often."""
    return CERTAIN / max(1, len(effects))


def clear(effects: Sequence[Effect], least: float = 1.0) -> list[Effect]:
    """Those that are significant among so many, and at least so many times as clear."""
    level = level_among(effects)
    return [effect for effect in effects if effect.clearness(level) > least]


@dataclass(frozen=True)
class Trial:
    """The rows on which alternatives are tried, in so many blocks of these numbers.

    The first `own` columns of W belong to the robot, whose `model` is None if they are not those of
    its regressor. Joints are weighted by `weights`, and rows are whitened by the `noise`, if there
    is one: torques need only those in these `places`. The alternatives that are `suspected` count
    even where they are not significant; those that are `shared` were fitted for other joints.
    Gains, a tilt and mismatches that are `fitted`, of joints (from 0), are in W.
    """

    rows: Rows
    own: int
    weights: Array
    estimates: Array
    model: Model | None
    number: Numbers
    count: int
    noise: ColouredNoise | None
    places: Numbers
    suspected: frozenset[str] = frozenset()
    shared: Set[str] = frozenset()
    fitted: Set[tuple[str, int]] = frozenset()

    @classmethod
    def of(
        cls,
        rows: Rows,
        own: int,
        weights: Array,
        estimates: Array,
        *,
        model: Model | None = None,
        noise: ColouredNoise | None = None,
        suspected: frozenset[str] = frozenset(),
        shared: Set[str] = frozenset(),
        fitted: Set[tuple[str, int]] = frozenset(),
    ) -> Trial:
        """From the rows of an estimation, and its estimates."""
        few = thinned(rows)
        places = noise.kept(few) if noise else np.arange(few.samples)
        numbers = block_numbers(few.at, few.h)
        return cls(
            few, own, weights, estimates, model, *numbers, noise, places, suspected, shared, fitted
        )

    @property
    def _apart(self) -> list[int]:
        """The joints whose gains are fitted."""
        return [j for name, j in self.fitted if name == RelativeGain.NAME]

    @cached_property
    def reference(self) -> int:
        """The joint (from 0) beside which the gains of the others are."""
        return reference(self.rows, self.estimates, self._apart)

    @property
    def bare(self) -> bool:
        """Whether nothing but offsets was fitted for other joints."""
        return not self.shared - {Offset.NAME}

    @cached_property
    def beyond(self) -> tuple[Products, dict[str, list[int]]]:
        """The products with what torques may have beyond the model, and the places of those."""
        return self.products(self.rows.scales, self._further)

    @cached_property
    def _further(self) -> dict[str, Array]:
        """The columns of what torques may have beyond the model."""
        signals = replace(
            Signals.of(self.rows, self.model, self.estimates),
            ripples=self.ripples.cycles,
            others=compared(self.rows, self.estimates, self._apart),
        )
        leans = any(name == Tilt.NAME for name, _ in self.fitted)
        kinds = (kind for name, kind in TORQUES.items() if not (leans and name == Tilt.NAME))
        found = {kind.NAME: kind.columns(signals) for kind in kinds}
        return {name: columns for name, columns in found.items() if columns is not None}

    @cached_property
    def _away(self) -> Array:
        """The scales of rows away from reversals."""
        return away_from_reversals(self.rows)

    @cached_property
    def _beyond_away(self) -> tuple[Products, dict[str, list[int]]]:
        """The same products of those rows."""
        return self.products(self._away, self._further)

    @cached_property
    def mismatches(self) -> tuple[Products, dict[str, list[int]]]:
        """The products with mismatches, and the places of the columns of all joints.

        The columns of what is fitted are 0, and where something is, only those are there that may
        widen intervals. A low-pass that is not known exactly looks like a joint that yields.
        """
        return self.products(self.rows.scales, self.secants)

    @cached_property
    def secants(self) -> dict[str, Array]:
        """The columns (samples, joints, joints) of mismatches."""
        if self.model is None or not self.rows.order:
            return {}
        joints = range(self.rows.y.shape[1])
        of = Gears(self.rows, self.model, self.estimates[: self.own])
        none = np.zeros_like(self.rows.y)
        columns = {
            name: [none if (name, j) in self.fitted else kind.secant(of, j) for j in joints]
            for name, kind in (MISMATCHES if self.bare else WIDESPREAD).items()
        }
        return {x: np.stack(each, axis=2) for x, each in columns.items()}

    def memories(self, plain: Solved) -> list[Effect]:
        """The effects of gaps, hysteresis and presliding, of the joints that are not fitted."""
        products, places = self.mismatches
        own = {x: columns for x, columns in places.items() if x in WIDESPREAD}
        found = self.beside(products, own, plain, plain) if own else []
        return [x if self._builds_up(x) else replace(x, told=Reversals.NAME) for x in found]

    def _builds_up(self, effect: Effect) -> bool:
        """Whether friction that builds up behind a reversal does so beyond what the low-pass makes.

        A joint that sticks leaves much the same in the rows next to a reversal.
        """
        if effect.name != Presliding.NAME or not effect.significant() or not self.rows.bandwidth:
            return True
        assert self.model
        sizes = np.maximum(np.nan_to_num(effect.amounts), Presliding.SMALL)
        of = Gears(self.rows, self.model, self.estimates[: self.own])
        each = [Presliding.secant(of, j, float(size)) for j, size in enumerate(sizes)]
        scales = away_from_reversals(self.rows, 1.0 / self.rows.bandwidth)
        products, places = self.products(scales, {Presliding.NAME: np.stack(each, axis=2)})
        plain = products.solved([])
        return plain is None or any(
            x.significant() for x in self.beside(products, places, plain, plain)
        )

    @cached_property
    def ripples(self) -> Ripples:
        """The likeliest ripple of the torque of each joint."""
        return Ripples.of(self.rows)

    @cached_property
    def plain(self) -> Solved | None:
        """The fit without any alternative; None if the rows do not determine it."""
        # Not of `beyond`: those that are refused by their errors alone never need its columns.
        return self.products(self.rows.scales, {})[0].solved([])

    def longer(self, white: Rows) -> Array:
        """How many times the errors of long disturbances exceed those of blocks (columns); >= 1.

        `white` are the rows of the estimation, whitened by the noise.
        """
        if self.plain is None:
            return np.ones(self.rows.W.shape[2])
        rows = white if self.noise else self.rows
        errors = autocovariance_errors(rows, self.plain.whole, self.weights)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = errors / jackknifed(self.plain.deviations)
        return np.asarray(np.where(ratios > 1.0, np.nan_to_num(ratios, posinf=1.0), 1.0))

    def cuts(self, longer: Array) -> tuple[tuple[float, Cut], ...]:
        """Cuts of the record and their times [s] from its first sample on.

        Their errors are so many times those of blocks.
        """
        if not self.plain:
            return ()
        found = cuts(self.beyond[0], longer, self.own)
        starts = self.rows.at[np.searchsorted(self.number, [cut.at for cut in found])]
        times = (starts - self.rows.at[0]) * self.rows.h
        return tuple(zip(times.tolist(), found, strict=True))

    def effects(self) -> tuple[Effect, ...]:
        """The effects of all alternatives that the rows determine."""
        if self.plain is None:
            return ()
        solved = self.products(self._away, {})[0].solved([])
        same = [(self.rows.scales, self.plain)]
        found = self.among_torques(self.plain)
        if solved:
            found.append(self.effect(Reversals.NAME, self.plain, self.plain, solved))
            same.insert(0, (self._away, solved))
        return (*found, *self.memories(self.plain), *self.signals(self.plain, same))

    def among_torques(self, without: Solved, given: Sequence[int] = ()) -> list[Effect]:
        """The effects of what torques may have beyond the model, and the columns that are given.

        `without` is the fit of these. A ripple must show away from reversals, too: what a low-pass
        leaves of friction there comes back at the same positions where a motion is periodic.
        """
        found = self.beside(*self.beyond, without, without, given)
        return [x for x in found if x.name != Ripple.NAME or self._ripples_away(x, given)]

    def _ripples_away(self, effect: Effect, given: Sequence[int]) -> bool:
        """Whether a ripple, if it is significant, is so away from reversals as well."""
        if not effect.significant():
            return True
        products, places = self._beyond_away
        kept = products.independent([*given])
        without = products.solved(kept)
        if without is None:
            return True
        own = {Ripple.NAME: places[Ripple.NAME]}
        return any(x.significant() for x in self.beside(products, own, without, without, kept))

    def errors_with_curves(self, joints: Collection[int]) -> Array:
        """The errors (own) if the friction of these joints (from 0) is any curve of the speed.

        With the shapes that were chosen alone, what friction is beside them looks better known.
        """
        signals, own = Signals.of(self.rows, self.model, self.estimates), list(joints)
        shapes = [diagonal(signals.friction(speed))[:, :, own] for speed in FINER]
        further = {Curvature.NAME: np.concatenate(shapes, axis=2)}
        products, places = self.products(self.rows.scales, further)
        solved = products.solved(products.independent(places[Curvature.NAME]))
        if solved is None or self.plain is None:
            return np.zeros(self.own)
        errors = jackknifed(solved.deviations[:, : self.own])
        curve = self.effect(Curvature.NAME, self.plain, self.plain, solved)
        curve = replace(curve, suspected=True)
        return np.asarray(np.hypot(errors, curve.bias))

    def products(
        self, scales: Array, further: dict[str, Array]
    ) -> tuple[Products, dict[str, list[int]]]:
        """The products with further columns, and the places of the columns of each name."""
        places, start = {}, self.rows.W.shape[2]
        for name, columns in further.items():
            places[name] = list(range(start, start + columns.shape[2]))
            start += columns.shape[2]
        parts = [self.rows.W, *further.values(), self.rows.y[:, :, None]]
        if self.noise:
            parts = [x[self.places] for x in parts]
        return self._of(parts, scales, self.places), places

    def _of(self, parts: Sequence[Array], scales: Array, places: Numbers) -> Products:
        """The products of rows in these places, which have the same distance in each run.

        The `parts` are their columns; all of them stand beside each other in a block at a time,
        for they are many, unless they are whitened.
        """
        scales, rows = scales[places], self.rows
        if self.noise:
            A = np.concatenate(parts, axis=2)
            parts = [self.noise.whitened(A, scales > 0.0, rows.at[places], rows.h)]
            scales = np.ones_like(scales)
        scales = (scales * self.weights)[:, :, None]
        edges = np.searchsorted(self.number[places], np.arange(self.count + 1)).tolist()
        blocks = (slice(a, b) for a, b in pairwise(edges))
        sums = (np.concatenate([x[k] for x in parts], axis=2) * scales[k] for k in blocks)
        return Products.of(sums, rows.W.shape[2])

    def beside(
        self,
        products: Products,
        places: dict[str, list[int]],
        plain: Solved,
        same: Solved,
        given: Sequence[int] = (),
    ) -> list[Effect]:
        """The effects of the further columns of each name that are not in the model already.

        The further columns that are `given` are in it.
        """

        def tried(name: str, columns: list[int]) -> list[Effect]:
            new = [c for c in products.independent([*given, *columns]) if c not in given]
            if PHENOMENA[name].SPARSE:
                new = [c for c in new if products.spread[c] >= BLOCKS]
            solved = products.solved([*given, *new]) if new else None
            if solved is None:
                return []
            tested = [new.index(c) if c in new else None for c in columns]
            return [self.effect(name, plain, same, solved, tested)]

        found = []
        for name, columns in places.items():
            effects = tried(name, columns)
            if first := PHENOMENA[name].FIRST:
                effects += tried(name, columns[:first])
            found += sorted(effects, key=lambda x: -x.clearness(CERTAIN))[:1]
        return found

    def signals(self, plain: Solved, same: list[tuple[Array, Solved]]) -> list[Effect]:
        """The effects of another soft sensor, and of what may be wrong with its signals.

        `same` are the scales of rows with which they can be tried, the better ones first, and the
        fits to these rows without any alternative.
        """
        smooth = smoothed(self.rows, self.model, self.estimates, self.own)
        if smooth is None:
            return []
        for scales, without in same:
            products = self._of([smooth.A], scales, smooth.centres)
            if parallel := products.solved([]):
                found = self.effect(Parallel.NAME, plain, without, parallel)
                return [found, *self.beside(products, smooth.places, plain, parallel)]
        return []

    def effect(
        self,
        name: str,
        plain: Solved,
        same: Solved,
        other: Solved,
        tested: Sequence[int | None] | None = None,
    ) -> Effect:
        """The effect of `other`, compared with the plain fit and with one on the same rows.

        What is `tested` are these of its further columns (None for one that it has not), or else
        how far the parameters move.
        """
        own, given = self.own, len(plain.whole)
        moved = other.whole[:own] - plain.whole[:own]
        errors = jackknifed(other.deviations[:, :own] - plain.deviations[:, :own])
        apart = other.whole[:own] - same.whole[:own]
        if tested is None:
            amounts, noise = apart, jackknifed(other.deviations[:, :own] - same.deviations[:, :own])
        else:
            amounts, noise = np.full((2, len(tested)), np.nan)
            there = [k for k, column in enumerate(tested) if column is not None]
            at = [given + column for column in tested if column is not None]
            amounts[there], noise[there] = other.whole[at], jackknifed(other.deviations[:, at])
        return Effect(
            name,
            moved,
            errors,
            apart,
            amounts,
            noise,
            self.count,
            suspected=name in self.suspected,
            shared=name in self.shared,
            searched=self.ripples.tried if name == Ripple.NAME else 1.0,
        )
