"""The optimisation of a curve from a random start, and the curve that then keeps its limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from scarid_cli.algorithms.design.aims import Columns
from scarid_cli.algorithms.design.constraints import Along, Constraint, Kinematic, Law
from scarid_cli.algorithms.design.criteria import NEGLIGIBLE, TINY, goal
from scarid_cli.algorithms.design.information import Experiment, Samples, typical_moments
from scarid_cli.algorithms.design.lagrangian import minimised
from scarid_cli.algorithms.trajectories.curve import Basis, Curve, instants, random_curve, room
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.arrays import Array

PENALTIES = (3.0, 30.0, 300.0, 1000.0)
ITERATIONS = 100  # with each penalty
REFINED = 200  # iterations, twice, with the last penalty, for the best of the starts
INFORMED = 5  # samples of the information in the time scale of a basis
CHECKED = 25  # of the limits of positions, velocities and accelerations
WATCHED = 10  # and of the laws, which change as slowly as positions do
SHRINK = 1e-3  # of a curve towards home, at first
PRECISION = 2e-3  # of the size of a motion that is as large as its limits allow
BATCH = 1024


@dataclass(frozen=True)
class Wanted:
    """What is asked of a motion.

    `noise` (joints) is the standard deviation of the torques [N m or N]; `rate` that of the log
    [Hz]; `known` the information from earlier experiments (parameters, parameters); `some` the
    indices of the parameters that are wanted, all others being nuisance parameters.
    """

    model: Columns
    basis: Basis
    home: Array
    limits: Limits
    laws: tuple[Law, ...]
    criterion: str
    noise: Array
    rate: float
    known: Array
    some: tuple[int, ...] = ()


@dataclass(frozen=True)
class Problem:
    """A motion to be optimised, with everything that does not depend on where it starts."""

    wanted: Wanted
    experiment: Experiment
    samples: Samples
    constraints: tuple[Constraint, ...]

    @classmethod
    def of(cls, wanted: Wanted) -> Problem:
        informed, checked, watched = (
            Samples.of(wanted.basis, wanted.home, _grid(wanted.basis, per))
            for per in (INFORMED, CHECKED, WATCHED)
        )
        constraints: list[Constraint] = [Kinematic(checked, wanted.limits)]
        constraints += [Along.of(watched, law) for law in wanted.laws]
        experiment = _experiment(wanted, informed.values.shape[2])
        return cls(wanted, experiment, informed, tuple(constraints))

    def value(self, curve: Curve) -> float:
        """The criterion of a curve."""
        return self.experiment.evaluate(self.samples, curve.coefficients)[0]

    def optimised(self, seed: int, start: int) -> Curve:
        """The curve found from the random start of this number."""
        rng = np.random.default_rng((seed, start))
        wanted = self.wanted
        first = random_curve(wanted.basis, wanted.home, wanted.limits, rng)
        return self._from(first, PENALTIES, ITERATIONS)

    def refined(self, curve: Curve) -> Curve:
        """A better curve, from one that is good already."""
        found = self._from(curve, PENALTIES[-1:] * 2, REFINED)
        return min(curve, found, key=self.value)

    def _from(self, curve: Curve, penalties: tuple[float, ...], iterations: int) -> Curve:
        wanted = self.wanted
        found = minimised(
            lambda coefficients: self.experiment.evaluate(self.samples, coefficients),
            self.constraints,
            curve.coefficients,
            wanted.limits.ddq,
            penalties,
            iterations,
        )
        return kept(Curve(curve.basis, curve.home, found), wanted.limits, wanted.laws)


def _experiment(wanted: Wanted, count: int) -> Experiment:
    """The experiment that so many samples of the motion stand for."""
    model = wanted.model
    typical = typical_moments(model, wanted.limits)
    squares = np.diag(typical)
    weights = wanted.rate * wanted.basis.duration / (count * wanted.noise**2)
    usual = float(weights.mean())
    floor = NEGLIGIBLE**2 * count
    return Experiment(
        model,
        goal(wanted.criterion, typical, wanted.some),
        weights,
        wanted.known + floor * usual * np.diag(np.maximum(squares, TINY * squares.max())),
        wanted.known / usual + floor * float(squares.max()) * np.eye(len(squares)),
    )


def _grid(basis: Basis, per_scale: int) -> Array:
    """Instants [s] from start to end, so many in the time scale of a basis."""
    return np.linspace(0.0, basis.duration, round(per_scale * basis.duration / basis.scale) + 1)


def kept(curve: Curve, limits: Limits, laws: tuple[Law, ...]) -> Curve:
    """The curve, shrunk towards home by as little as makes it keep its limits at every instant."""
    curve = curve.scaled(np.minimum(1.0, room(curve, limits)))
    if _within(curve, laws):
        return curve
    beyond, size, step = 1.0, 1.0 - SHRINK, SHRINK
    while size > 0.0 and not _within(_shrunk(curve, size), laws):
        beyond, size, step = size, size - 2.0 * step, 2.0 * step
    size = max(size, 0.0)
    while beyond - size > PRECISION:
        middle = 0.5 * (beyond + size)
        beyond, size = (beyond, middle) if _within(_shrunk(curve, middle), laws) else (middle, size)
    return _shrunk(curve, size)


def _shrunk(curve: Curve, size: float) -> Curve:
    return curve.scaled(np.full(len(curve.home), size))


def _within(curve: Curve, laws: tuple[Law, ...]) -> bool:
    return max((m.max() for m in margins(curve, laws)), default=0.0) <= 0.0


def margins(curve: Curve, laws: tuple[Law, ...]) -> list[Array]:
    """The largest violation of each law (names), at instants a millisecond apart."""
    t = instants(curve.duration)
    found = [np.full(len(law.names), -np.inf) for law in laws]
    for first in range(0, len(t) if laws else 0, BATCH):
        motion = curve.sample(t[first : first + BATCH])
        for largest, law in zip(found, laws, strict=True):
            np.maximum(largest, law.exact.violations(motion).max(axis=1), out=largest)
    return found
