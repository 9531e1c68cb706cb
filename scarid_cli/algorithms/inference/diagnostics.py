"""The diagnostics of an estimation: errors, effects of alternatives to the model, and residuals.

The errors that leave out blocks and the sums of squares are computed from all rows of a record,
everything else from a subsample if the record is long.
"""

from __future__ import annotations

from collections.abc import Collection, Set
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from scarid_cli.algorithms.beyond.additions import Addition
from scarid_cli.algorithms.beyond.catalogue import POSITIONS, TORQUES
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.rows import LowPass
from scarid_cli.algorithms.beyond.torques import Curvature, RelativeGain
from scarid_cli.algorithms.effects.effects import Effect, Trial, of_known_size
from scarid_cli.algorithms.effects.explanations import Explanation, explanations
from scarid_cli.algorithms.effects.mismatched import mismatches
from scarid_cli.algorithms.inference.consequences import (
    Consequences,
    Uncertainty,
    consequences,
    gain_sensitivities,
)
from scarid_cli.algorithms.inference.gains import relative
from scarid_cli.algorithms.regression.estimation import Estimation
from scarid_cli.algorithms.regression.information import Fit
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.regression.treatment import GainErrors
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.bursts import Interval, bursts_of
from scarid_cli.algorithms.uncertainty.cuts import Cut
from scarid_cli.algorithms.uncertainty.jackknife import (
    RobustCovariance,
    inflation,
    interval_quantiles,
    jackknife,
    jackknife_of_blocks,
    quantile,
)
from scarid_cli.algorithms.uncertainty.residuals import JointResidual, residuals
from scarid_cli.algorithms.uncertainty.trimmed import trimmed
from scarid_cli.arrays import Array, median

# Times what lasts in the residual: the fit has taken up a part of what the model lacks, and another
# motion has it elsewhere (benchmarks/within.py, docs/design/verdict.md).
LACKING = 2.0


@dataclass(frozen=True)
class Diagnostics:
    """What the residuals show about an estimation.

    `covariance` is robust to autocorrelated residuals; it is None for an estimator without scores.
    `scatter` (columns) are standard errors from the noise alone: the larger of those from leaving
    out blocks and those from the autocovariance of the residuals. `errors` (own parameters) also
    allow for the `effects` of alternatives to the model and for the errors of the torque constants.
    `matrix` (own, own) is the covariance of the estimates with all of that. `blocks` is the
    effective number of blocks, and `quantiles` (own) are half the widths of 95 % intervals, in
    errors. `gains` (joints, own) is how far the estimates move per relative
    change of the torque constant of a joint. `bursts` are the intervals that the model does not
    explain, counted from sample 0 of a record that is known as a whole. `cuts` are the estimates
    before and after some times [s] from its first sample on. `offsets` [N m or N] are those of the
    torques of joints (from 0) that were fitted beside the parameters, and `additions` what else
    was; gains are relative to the joint `reference` (from 0). Each of the `explanations` alone
    explains nearly all that the torques are beyond the model; `mismatches` may, which the whole
    estimation tells.
    `cycles` (ripples, joints) are the periods per rad or m of the likeliest ripples. `totals`
    (joints, columns + 2, columns + 2) are the products of [W, y, 1] of the rows as they were fitted
    and weighted, `counts` (joints) their numbers, and `inflation` is how much larger variances are
    than those for white residuals.
    """

    covariance: RobustCovariance | None
    blocks: float
    scatter: Array
    errors: Array
    quantiles: Array
    matrix: Array
    joints: tuple[JointResidual, ...]
    effects: tuple[Effect, ...]
    gains: Array
    consequences: Consequences
    totals: Array
    counts: Array
    inflation: float
    bursts: tuple[Interval, ...] = ()
    cuts: tuple[tuple[float, Cut], ...] = ()
    explanations: tuple[Explanation, ...] = ()
    mismatches: tuple[Explanation, ...] = ()
    cycles: Array = field(default_factory=lambda: np.zeros((0, 0)))
    offsets: dict[int, float] = field(default_factory=dict)
    additions: tuple[Addition, ...] = ()
    reference: int = 0

    @property
    def width(self) -> float:
        """Half the width of a 95 % interval, in standard errors."""
        return quantile(0.975, self.blocks - 1.0)

    @property
    def lacking(self) -> Array:
        """Half the 95 % interval of the torque by the parameters and what the model lacks (joints).

        Of the torque that another motion needs, relative to it; nan if that is not known.
        """
        lasting, torques = np.transpose([[x.lasting, x.torque] for x in self.joints])
        with np.errstate(divide="ignore", invalid="ignore"):
            lacks = LACKING * lasting / torques
        return np.asarray(np.hypot(self.width * self.consequences.torque, lacks))

    @property
    def needed(self) -> Array:
        """The same with an offset, of which no log tells whether it is the sensor's (joints)."""
        offsets = np.zeros(len(self.joints))
        for j, size in self.offsets.items():
            offsets[j] = size / (self.joints[j].torque or np.nan)
        return np.asarray(np.hypot(self.lacking, offsets))


@dataclass(frozen=True)
class Diagnosis:
    """What is asked about an estimation, each part of which is computed when it is asked for.

    `record` has the blocks of the whole record if `rows` are only a subsample of it. The first
    `own` columns of W belong to the robot, whose `model` is None if the rows are not those of its
    regressor; the others are nuisance parameters. `modelled` (columns) are the estimates that
    predict torques later, by which the residuals of the joints are stated. `doubt` (own) is how far
    the estimates may be off because torques may lead as behind a low-pass or as behind a delay.
    `gain_errors` are the relative standard errors of the torque constants. Intervals allow for the
    alternatives that are `suspected` even where they are not significant, for all that is possible
    of those that are `shared`, because other joints have them, and for any curve of the friction of
    the joints (from 0) of `curves`. Gains and mismatches that are `fitted`, of joints (from 0),
    are in W. All parameters are `rescaled` if the torque of the other one of two joints is wrong.
    """

    rows: Rows
    found: Estimation
    own: int
    record: Blocks | None = None
    modelled: Array | None = None
    model: Model | None = None
    doubt: Array | None = None
    gain_errors: GainErrors = 0.0
    suspected: frozenset[str] = frozenset()
    shared: Set[str] = frozenset()
    curves: Collection[int] = ()
    fitted: Set[tuple[str, int]] = frozenset()
    rescaled: float = 1.0

    @cached_property
    def errors(self) -> Array:
        """The errors from leaving out blocks (columns), of which `scatter` is at least as large."""
        return self._noise[2]

    @cached_property
    def scatter(self) -> Array:
        """Standard errors from the noise alone (columns)."""
        return np.asarray(self.errors * self._longer)

    @cached_property
    def effects(self) -> tuple[Effect, ...]:
        """How far the alternatives to the model move the estimates."""
        trial, estimates = self._trial, self.found.fit.estimates
        found = [relative(x, trial.reference, estimates) for x in trial.effects()]
        if self.doubt is not None:
            found.append(of_known_size(LowPass.NAME, self.doubt))
        if self.rescaled != 1.0:  # one of two torques is wrong, and nobody knows which
            moved = (self.rescaled - 1.0) * estimates[: self.own]
            found.append(of_known_size(RelativeGain.NAME, moved))
        return tuple(found)

    @property
    def diagnostics(self) -> Diagnostics:
        """All of it."""
        rows, found, own, trial = self.rows, self.found, self.own, self._trial
        covariance, blocks, _ = self._noise
        estimates = found.fit.estimates
        gains = gain_sensitivities(self._seen.total, self._weights)[:, :own]
        known = self.scatter[:own]
        if self.curves:
            known = np.maximum(known, trial.errors_with_curves(self.curves))
        moves = moves_by(self.gain_errors, gains)
        stated = _stated(found.fit.part(slice(own)), known, self.effects, moves)
        modelled = estimates if self.modelled is None else self.modelled
        explained = self.model and trial.plain
        return Diagnostics(
            covariance=covariance and covariance.part(own),
            blocks=blocks,
            scatter=self.scatter,
            errors=stated.errors,
            quantiles=interval_quantiles(blocks, self._longer[:own]),
            matrix=stated.matrix,
            joints=residuals(rows, modelled, self.record, estimates),
            effects=self.effects,
            gains=gains,
            consequences=consequences(
                self._whole,
                self._seen,
                self._weights,
                estimates,
                stated.uncertainty,
                self.model,
                rows.motion[0],
            ),
            totals=(self._weights**2)[:, None, None] * self._seen.total,
            counts=_counts(self._white, self._whole, whitened=found.noise is not None),
            inflation=_inflation(found.fit, self.scatter),
            bursts=() if self.record else bursts_of(rows, trimmed(self._whole)),
            cuts=trial.cuts(self._longer),
            explanations=explanations(trial, self.effects) if explained else (),
            mismatches=mismatches(trial, self.effects) if explained and trial.bare else (),
            cycles=trial.ripples.cycles,
            reference=trial.reference,
        )

    @cached_property
    def _white(self) -> Rows:
        """The rows, whitened as they were fitted."""
        return self.found.noise.rows(self.rows) if self.found.noise else self.rows

    @cached_property
    def _whole(self) -> Blocks:
        """The blocks of the record."""
        return self.record or Blocks.every(self.rows.h).add(self.rows).whole()

    @cached_property
    def _seen(self) -> Blocks:
        """Those of the rows as they were fitted."""
        if not self.found.noise:
            return self._whole
        return Blocks.every(self.rows.h).add(self._white).whole()

    @cached_property
    def _weights(self) -> Array:
        return _weights(self.found, self.rows.y.shape[1])

    @cached_property
    def _noise(self) -> tuple[RobustCovariance | None, float, Array]:
        return _noise_errors(self._white, self.found, self.record, self._seen)

    @cached_property
    def _longer(self) -> Array:
        return self._trial.longer(self._white)

    @cached_property
    def _trial(self) -> Trial:
        return Trial.of(
            self.rows,
            self.own,
            self._weights,
            self.found.fit.estimates,
            model=self.model,
            noise=self.found.noise,
            suspected=self.suspected,
            shared=self.shared,
            fitted=self.fitted,
        )


@dataclass(frozen=True)
class _Stated:
    """The errors (own) and the covariance (own, own) of the estimates that are stated."""

    errors: Array
    matrix: Array
    uncertainty: Uncertainty


def _stated(fit: Fit, scatter: Array, effects: tuple[Effect, ...], gains: Array) -> _Stated:
    """From the errors of the noise, the effects of alternatives, and the moves by wrong gains."""
    shifts = np.array([effect.bias for effect in effects]).reshape(-1, len(scatter))
    widest = np.max(shifts**2, axis=0, initial=0.0) + np.sum(gains**2, axis=0)
    moves = {effect.name: effect.direction(scatter) for effect in effects}
    for effect in effects:
        if effect.name in POSITIONS and effect.counts:
            for other in POSITIONS[effect.name].BESIDE:
                moves.pop(other, None)  # whose columns are among its own
    # What other columns gain the parameters lose: the torque on this motion remains what it was.
    lasting = [move for name, move in moves.items() if name not in TORQUES]
    # Without its column this one would change the torque most, where `scarid urdf` must keep it.
    most = [move for name, move in moves.items() if name != Curvature.NAME]
    return _Stated(
        errors=np.sqrt(scatter**2 + np.nan_to_num(widest)),
        matrix=_matrix(fit, scatter, [*most, *gains]),
        uncertainty=Uncertainty(
            torque=_matrix(fit, scatter, [*lasting, *gains]),
            noise=_matrix(fit, scatter, []),
            biases=shifts[[effect.name in TORQUES for effect in effects]],
        ),
    )


def moves_by(errors: GainErrors, gains: Array) -> Array:
    """How far the estimates move (directions, own) by the errors of the torque constants.

    `gains` (joints, own) is how far they move per relative change of the constant of a joint.
    """
    if isinstance(errors, float | int):
        return np.asarray(errors * gains)
    found: Array = np.array(errors).reshape(-1, len(gains)) @ gains
    return found


def _weights(found: Estimation, joints: int) -> Array:
    """What the rows of each joint were multiplied by (joints)."""
    if found.scores is None or found.scores.whitening is None:
        return np.ones(joints)
    return np.asarray(np.diag(found.scores.whitening), dtype=np.float64)


def _noise_errors(
    rows: Rows, found: Estimation, record: Blocks | None, whole: Blocks
) -> tuple[RobustCovariance | None, float, Array]:
    """The robust covariance, the effective number of blocks, and the errors from leaving them out.

    Without scores the errors are those for white residuals, multiplied by the ratio of robust to
    white errors of least squares on the same rows.
    """
    if found.scores is None:
        blocks, ratio = inflation(whole, rows)
        return None, blocks, np.asarray(found.fit.standard_errors() * ratio)
    covariance = jackknife_of_blocks(record, rows, found) if record else jackknife(rows, found)
    return covariance, covariance.effective, covariance.errors


def _counts(white: Rows, whole: Blocks, *, whitened: bool) -> Array:
    """The number of rows of each joint that were fitted."""
    if whitened:  # all rows of these are in the memory
        return np.asarray(np.count_nonzero(white.scales, axis=0), dtype=np.float64)
    return np.asarray(whole.total[:, -1, -1])


def _inflation(fit: Fit, scatter: Array) -> float:
    """The median ratio of the variances to the classical ones, of estimates with `scatter`."""
    classical = fit.variance * np.diag(fit.unit_covariance)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = scatter[: len(classical)] ** 2 / classical
    ratios = ratios[np.isfinite(ratios) & (ratios > 0.0)]
    return float(median(ratios)) if len(ratios) else 1.0


def _matrix(fit: Fit, scatter: Array, shifts: list[Array]) -> Array:
    """The covariance of the estimates, scaled to their errors; nan if these are not known.

    It is the classical covariance s^2 (W'W)^-1, multiplied by the median ratio of robust to
    classical variances, plus the squares of the shifts. Autocorrelated residuals increase all
    errors, but do not change the directions that the motion leaves undetermined. The robust
    covariance itself would not do, because its rank is below the number of its blocks.
    """
    sized = fit.variance * fit.unit_covariance * _inflation(fit, scatter)
    for shift in shifts:
        sized = sized + np.outer(shift, shift) if np.isfinite(shift).all() else sized
    return np.asarray(sized)
