"""From the final state of an estimator to its outcome: estimates, errors and diagnostics."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from scarid_cli.algorithms.beyond.additions import Addition, gains
from scarid_cli.algorithms.beyond.catalogue import TORQUES
from scarid_cli.algorithms.beyond.gears import Presliding
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.beyond.mounting import Tilt
from scarid_cli.algorithms.beyond.signals import compared, reference
from scarid_cli.algorithms.beyond.torques import (
    DECAYED,
    Cable,
    Cube,
    Offset,
    RelativeGain,
    Ripple,
    Spring,
)
from scarid_cli.algorithms.changes.evidence import LogEvidence, Products
from scarid_cli.algorithms.effects.additions import Shapes, of_explanation
from scarid_cli.algorithms.effects.effects import Effect, clear
from scarid_cli.algorithms.effects.explanations import Explanation
from scarid_cli.algorithms.effects.offsets import offset_joints, offsets, with_offsets
from scarid_cli.algorithms.effects.ringing import with_ringing
from scarid_cli.algorithms.inference.alignment import Aligned, Lead, aligned
from scarid_cli.algorithms.inference.choosing import friction
from scarid_cli.algorithms.inference.consequences import few
from scarid_cli.algorithms.inference.diagnostics import Diagnosis, Diagnostics
from scarid_cli.algorithms.inference.essential import Essential, Noise, essential
from scarid_cli.algorithms.inference.gains import Gain, apart, fitted, known
from scarid_cli.algorithms.regression.estimation import BaseEstimator, Estimation
from scarid_cli.algorithms.regression.information import Fit, NotIdentifiableError
from scarid_cli.algorithms.regression.rows import Rows, faded, regressed, spread, thinned
from scarid_cli.algorithms.regression.treatment import GainErrors, Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.uncertainty.blocks import Blocks
from scarid_cli.algorithms.uncertainty.checkpoint import Checkpoint
from scarid_cli.algorithms.uncertainty.joint_products import JointProducts
from scarid_cli.arrays import Array, median

SHAPED = 4_000_000  # numbers of W, of parts of a long record, that tell the sizes of shapes
ROWS = 3  # behind a reversal, that the build-up of friction must last


@dataclass(frozen=True)
class Problem:
    """An estimation and the rows that it is judged by.

    The first `own` columns of W belong to the robot's parameters, the others to nuisance
    parameters. `record` has the blocks of all rows if `rows` are a subsample. `model` is None if
    the columns of W are not those of the robot's regressor. The first nuisance parameters are the
    `additions`, then the offsets of the torques of some joints, `offsets` (from 0). `lead` is that
    of the torques, None if it was not fitted; what remains of it is the last parameter, if the log
    shows it.
    """

    rows: Rows
    found: Estimation
    own: int
    record: Blocks | None
    model: Model | None
    lead: Lead | None = None
    offsets: tuple[int, ...] = ()
    additions: tuple[Addition, ...] = ()

    @property
    def delayed(self) -> bool:
        """Whether the last column is that of the delay."""
        return self.lead is not None and self.lead.shown

    @property
    def rest(self) -> float:
        """What remains of the delay [s] in these rows."""
        return float(self.found.fit.estimates[-1]) if self.delayed else 0.0

    @property
    def modelled(self) -> Array:
        """The estimates that predict torques: of nuisance parameters the delay, and what lasts."""
        estimates = self.found.fit.estimates.copy()
        estimates[self.own : -1 if self.delayed else None] = 0.0
        for k, addition in enumerate(self.additions, start=self.own):
            estimates[k] = addition.size if addition.lasts else 0.0
        return estimates

    def diagnosis(
        self, gain_errors: GainErrors, suspected: frozenset[str] = frozenset()
    ) -> Diagnosis:
        doubt = self.lead.doubt if self.lead else None
        return Diagnosis(
            self.rows,
            self.found,
            self.own,
            self.record,
            modelled=self.modelled,
            model=self.model,
            doubt=None if doubt is None else doubt[: self.own],
            gain_errors=gain_errors,
            suspected=suspected,
            shared=self._shared,
            curves={x.joint for x in self.additions if x.name in DECAYED},
            fitted={(x.name, x.joint) for x in self.additions if x.mismatch or x.entry.RELATIVE},
            rescaled=self._rescaled,
        )

    @property
    def _rescaled(self) -> float:
        """How large the parameters are if the gain that was fitted is that of the other of two."""
        found = [1.0 + x.size for x in self.additions if x.name == RelativeGain.NAME]
        if len(found) != 1:  # asked first: to find the joints that share parameters takes all rows
            return 1.0
        others = compared(self.rows, self.found.fit.estimates[: self.own])
        return found[0] if np.count_nonzero(others) == 1 else 1.0

    @property
    def _shared(self) -> set[str]:
        """What other joints may have as well: of an offset beside a spring nobody knows."""
        names = {Cable.NAME if x.name == Cube.NAME else x.name for x in self.additions}
        own = names - {Offset.NAME, Tilt.NAME}
        return own | ({Offset.NAME} if self.offsets else set())

    def diagnostics(
        self, gain_errors: GainErrors, suspected: frozenset[str] = frozenset()
    ) -> Diagnostics:
        return self.judged(self.diagnosis(gain_errors, suspected))

    def judged(self, diagnosis: Diagnosis) -> Diagnostics:
        """The diagnostics, with the offsets and the additions, which are columns of these rows."""
        found = diagnosis.diagnostics
        sizes = self.found.fit.estimates[self.own + len(self.additions) :].tolist()
        offsets = dict(zip(self.offsets, sizes, strict=False))
        found = replace(found, offsets=offsets, additions=self._with_errors(found.scatter))
        return self._with_slack(self.model.robot, self.model.kept, found) if self.model else found

    def _with_errors(self, errors: Array) -> tuple[Addition, ...]:
        """The additions, with those of these errors (columns) that are theirs."""
        own = errors[self.own : self.own + len(self.additions)].tolist()
        return tuple(replace(x, error=e) for x, e in zip(self.additions, own, strict=True))

    def shows(self, explanation: Explanation, errors: Array) -> bool:
        """Whether the additions, of this explanation, are larger than their errors (columns).

        These errors are those of disturbances that last, too, of which blocks know nothing. An
        offset and a ripple go with others, and do not count beside them. Of each kind of mismatch
        one joint must exceed the threshold, and all `each`.
        """
        sizes = self.found.fit.estimates[self.own : self.own + len(self.additions)]
        ratios = np.abs(sizes) / errors[self.own : self.own + len(self.additions)]
        names = np.array([addition.name for addition in self.additions])
        if any(addition.mismatch for addition in self.additions):
            largest = [ratios[names == name].max() for name in {*names.tolist()}]
            return bool(min(largest) > explanation.threshold and ratios.min() > explanation.each)
        waves = {part.NAME for part in Ripple.PARTS}
        own = {*names.tolist()} - {Offset.NAME, *waves} or waves
        return bool(ratios[[name in own for name in names]].max() > explanation.threshold)

    @property
    def possible(self) -> bool:
        """Whether there are such additions; presliding that is over within ROWS is not seen."""
        accelerations = np.sqrt(np.mean(self.rows.motion[2] ** 2, axis=1))
        least = 0.25 * accelerations * (ROWS * self.rows.h) ** 2  # half the distance from rest
        return all(
            x.possible and not (x.name == Presliding.NAME and x.size < least[x.joint])
            for x in self.additions
        )

    def _with_slack(self, robot: Robot, kept: list[int], found: Diagnostics) -> Diagnostics:
        """The diagnostics, whose errors of the offsets allow for where springs are slack.

        An offset is the torque where its joint is at 0, if the spring of this joint is slack there.
        No log can tell; it may be as far away as the positions of the log are.
        """
        moved = np.zeros(self.own)
        squares = np.mean(self.rows.motion[0] ** 2, axis=1)
        springs = {x.joint: x.size for x in self.additions if x.name == Spring.NAME}
        for index, joint in offset_joints(robot).items():
            if joint in springs and index in kept:
                moved[kept.index(index)] = abs(springs[joint]) * float(np.sqrt(squares[joint]))
        matrix = found.matrix + np.diag(moved**2)
        return replace(found, errors=np.hypot(found.errors, moved), matrix=matrix)

    def products(self, found: Diagnostics) -> JointProducts | None:
        """What the rows of each joint say, with the torques as they were logged."""
        if not self.model:
            return None
        gains = [
            k for k, x in enumerate(self.additions, start=self.own) if x.name == RelativeGain.NAME
        ]
        return JointProducts.of(found.totals, self.own, gains, found.counts, found.inflation)

    @property
    def compared(self) -> Rows:
        """The rows without their gains, and without columns that a comparison has by itself."""
        start = self.own + len(self.additions)
        dropped = {*range(start, start + len(self.offsets))}
        dropped |= {k for k, x in enumerate(self.additions, self.own) if x.entry.COMPARED}
        kept = [k for k in range(self.rows.W.shape[2] - self.delayed) if k not in dropped]
        tilts = [k for k, x in enumerate(self.additions, self.own) if x.name == Tilt.NAME]
        y = self.rows.y - self.rows.W[:, :, tilts] @ self.found.fit.estimates[tilts]
        torques = y / gains(self.additions, self.rows.y.shape[1])
        return replace(self.rows, W=self.rows.W.take(kept, axis=2), y=torques)

    def reduced(self, to: Essential) -> Problem:
        """The problem with only the essential parameters."""
        rows = replace(self.rows, W=self.rows.W.take(to.kept, axis=2))
        scores = self.found.scores
        if scores and scores.instruments is not None:
            scores = replace(scores, instruments=scores.instruments[:, :, to.kept])
        own = self.own - len(to.dropped)
        return replace(
            self,
            rows=rows,
            found=replace(self.found, fit=to.fit, scores=scores),
            own=own,
            record=self.record.columns(to.kept) if self.record else None,
            model=self.model and replace(self.model, kept=to.kept[:own]),
            lead=self.lead and self.lead.part(to.kept),
        )


@dataclass(frozen=True)
class Outcome:
    """The outcome of an estimation.

    `found` and `diagnostics` refer to the parameters with the indices `kept`; `reduction` is set if
    the model was reduced to essential parameters. `full` is the fit of all parameters, before any
    were dropped, and `covariance` their covariance, nan if it is not known. `delay` is the fitted
    delay of the torques and its standard error [s], nan if the log does not show it, `low_pass`
    whether they lead as behind a low-pass. `excitation` (parameters) is the root-mean-square torque
    that one unit of each parameter causes on this motion. `samples` is the number of samples, of
    which every `thin`-th is fitted, in every `stride`-th part of the record. `evidence` is that of
    the rows, at these estimates, which later logs are compared with. `products` are those of the
    rows of each joint, None without a model; they and the `effects` of alternatives are those
    before any parameters were dropped.
    """

    found: Estimation
    diagnostics: Diagnostics
    kept: list[int]
    reduction: Essential | None
    full: Fit
    covariance: Array
    delay: tuple[float, float] | None
    low_pass: bool
    excitation: Array
    samples: int
    thin: int
    stride: int
    evidence: LogEvidence
    products: JointProducts | None
    effects: tuple[Effect, ...]


def outcome(
    estimator: BaseEstimator,
    initial: Array,
    end: Checkpoint,
    treatment: Treatment,
    robot: Robot,
) -> Outcome:
    """The outcome, from the checkpoint at the end of a record.

    The treatment says whether the delay of the torques is fitted too, and parameters are dropped.
    """
    given = _Given(estimator, initial, end, robot, align=treatment.align)
    explain = _with_friction if treatment.choose_friction and treatment.align else _explained
    whole, diagnostics = explain(given, treatment.gain_errors)
    problem, products, effects = whole, whole.products(diagnostics), diagnostics.effects
    covariance, reduction = diagnostics.matrix, None
    thin = end.subsample.thin if treatment.align else 1
    if treatment.essential:
        noise = _noise(whole, diagnostics, end.subsample.counted // thin)
        reduction = essential(whole.found.fit, noise, whole.own)
        if reduction.dropped:
            problem = whole.reduced(reduction)
            diagnostics = problem.diagnostics(treatment.gain_errors)
    own, fit = problem.own, problem.found.fit
    kept = (reduction.kept if reduction else list(range(own)))[:own]
    lead, delay = problem.lead, None
    if lead:
        error = float(diagnostics.scatter[-1])
        delay = (lead.seconds + problem.rest, error) if lead.shown else (np.nan, np.nan)
    return Outcome(
        found=replace(problem.found, fit=fit.part(slice(own))),
        diagnostics=diagnostics,
        kept=kept,
        reduction=reduction,
        full=whole.found.fit.part(slice(whole.own)),
        covariance=covariance,
        delay=delay,
        low_pass=lead is not None and lead.low_pass,
        excitation=_excitation(whole),
        samples=end.subsample.total,
        thin=thin,
        stride=end.subsample.stride if treatment.align else 1,
        evidence=_evidence(whole, fit.estimates[:own], kept, problem.rest),
        products=products,
        effects=effects,
    )


def _evidence(whole: Problem, estimates: Array, kept: list[int], delay: float) -> LogEvidence:
    """The evidence about all parameters, of which those that were dropped are zero.

    `delay` [s] is what remains of the delay of the torques of these rows.
    """
    theta = np.zeros(whole.own)
    theta[kept] = estimates
    return Products.of(whole.compared, theta, delay, whole.model).usual


@dataclass(frozen=True)
class _Given:
    """What a problem is made from."""

    estimator: BaseEstimator
    initial: Array
    end: Checkpoint
    robot: Robot
    align: bool


def _explained(given: _Given, gain_errors: GainErrors) -> tuple[Problem, Diagnostics]:
    """The problem with what alone explains nearly all that the model does not; its diagnostics.

    If nothing does, it is the plain one. With it, what was significant before must not be clear,
    nor another alternative for the torques.
    """
    plain = _problem(given)
    diagnostics = plain.diagnostics(gain_errors)
    if not (given.align and plain.model):
        return plain, diagnostics
    candidates = [*diagnostics.explanations, *diagnostics.mismatches]
    beside = plain, diagnostics
    for explanation in sorted(candidates, key=lambda x: -x.clearness):
        if accepted := _accepted(given, beside, explanation, gain_errors):
            return _regauged(given, *beside, *accepted, gain_errors)
    return plain, diagnostics


def _accepted(
    given: _Given,
    beside: tuple[Problem, Diagnostics],
    explanation: Explanation,
    gain_errors: GainErrors,
) -> tuple[Problem, Diagnostics] | None:
    """The problem with an explanation, and its diagnostics; None if it does not hold beside them.

    `beside` are the plain ones.
    """
    plain, before = beside
    assert plain.model
    try:
        shapes = _shapes(given, plain, plain.model, explanation)
        if shapes.curved and not shapes.possible:
            return None
        wider = _problem(given, shapes)
    except NotIdentifiableError:
        return None
    suspected = _suspected(before)
    diagnosis = wider.diagnosis(gain_errors, suspected)
    if not (wider.possible and _shown(wider, explanation, diagnosis)):
        return None
    left = {effect.name for effect in clear(diagnosis.effects, explanation.rest)}
    new = left if shapes.curved else left & {*suspected, *TORQUES}
    return None if new - explanation.kindred else (wider, wider.judged(diagnosis))


def _shown(wider: Problem, explanation: Explanation, diagnosis: Diagnosis) -> bool:
    """Whether the additions are larger than their errors.

    Those from leaving out blocks are asked first: they are known in a tenth of the time of
    `scatter`, which is no smaller.
    """
    first = wider.shows(explanation, diagnosis.errors)
    return first and wider.shows(explanation, diagnosis.scatter)


def _regauged(
    given: _Given,
    plain: Problem,
    before: Diagnostics,
    wider: Problem,
    found: Diagnostics,
    gain_errors: GainErrors,
) -> tuple[Problem, Diagnostics]:
    """The problem with gains relative to most joints, if these are apart from the reference.

    So a torque constant that is wrong for the joint with the largest torque is that of this one,
    and not of all others.
    """
    own = fitted(found, wider.own)
    if not own or not plain.model:
        return wider, found
    first = reference(plain.rows, plain.found.fit.estimates[: plain.own])
    every = [Gain(first, 1.0, 0.0), *own, *known(found)]
    if (less := apart(every, first)) is None:
        return wider, found
    rest = [x for x in wider.additions if x.name != RelativeGain.NAME]
    added = [Addition(RelativeGain.NAME, x.joint, 1.0, x.factor - 1.0) for x in less]
    try:
        other = _problem(given, _beside(given, plain, plain.model, (*rest, *added)))
    except NotIdentifiableError:
        return wider, found
    suspected = _suspected(before)
    diagnostics = other.diagnostics(gain_errors, suspected)
    more = {x.name for x in clear(diagnostics.effects)} - {x.name for x in clear(found.effects)}
    return (wider, found) if more else (other, diagnostics)


def _suspected(diagnostics: Diagnostics) -> frozenset[str]:
    """The names of the alternatives that are clear."""
    return frozenset(effect.name for effect in clear(diagnostics.effects))


def _with_friction(given: _Given, gain_errors: GainErrors) -> tuple[Problem, Diagnostics]:
    """The problem with the friction that is worth fitting; its diagnostics."""
    plain, diagnostics = _explained(given, gain_errors)
    if not plain.model:
        return plain, diagnostics
    theta = plain.found.fit.estimates[: plain.own]
    fitted = plain.additions, plain.offsets
    added, worths = friction(plain.rows, plain.model, theta, diagnostics.cycles, *fitted)
    problem = plain
    if added:
        first = _problem(given)
        first = replace(first, rows=first.compared)  # without offsets, which may be among those
        shapes = _beside(given, first, plain.model, (*plain.additions, *added))
        problem = _problem(given, shapes)
        suspected = _suspected(diagnostics)
        diagnostics = problem.diagnostics(gain_errors, suspected)
    extra = {**problem.found.extra, "friction": [worth.extra for worth in worths]}
    return replace(problem, found=replace(problem.found, extra=extra)), diagnostics


def _shapes(given: _Given, plain: Problem, model: Model, explanation: Explanation) -> Shapes:
    """The shapes of what explains the torques, with the estimates beside it."""
    constant = {*offset_joints(given.robot).values(), *plain.offsets}
    additions = of_explanation(explanation, thinned(plain.rows), constant)
    return _beside(given, plain, model, additions)


def _beside(given: _Given, plain: Problem, model: Model, additions: tuple[Addition, ...]) -> Shapes:
    """The shapes of additions, with the estimates beside them."""
    rows, own, count = spread(thinned(plain.rows), SHAPED), plain.own, plain.rows.W.shape[2]
    shapes = Shapes(additions, model, plain.found.fit.estimates[:own])
    for _ in range(shapes.refits):
        wide = shapes.beside(rows)
        start = np.append(given.initial, np.zeros(wide.W.shape[2] - own))
        estimator = given.estimator.widened(len(start) - own).quick()
        found = estimator.of_rows(wide, start).fit.estimates
        shapes = replace(shapes, theta=found[:own], additions=shapes.sized(found[count:]))
        if not shapes.possible:
            break
    return shapes


def _problem(given: _Given, shapes: Shapes | None = None) -> Problem:
    """The problem, with these shapes of torques beside the model."""
    estimator, initial, end, robot = given.estimator, given.initial, given.end, given.robot
    rows, lead, joints = regressed(end.subsample.rows(), robot), None, tuple[int, ...]()
    if given.align:
        rows = end.left_out.settled(rows)
        rows = shapes.beside(rows) if shapes else rows
        joints = offsets(rows, robot, shapes.constant if shapes else ())
        fitted = _aligned(estimator, initial, with_offsets(rows, joints), robot)
        rows, found, own, lead = fitted.rows, fitted.found, len(initial), fitted.lead
    else:
        found = estimator.fit(end.state)
        own = len(found.fit.estimates)
    model = Model(robot, list(range(own))) if own == len(robot.parameters) else None
    if found.scores and found.scores.rows:
        rows = found.scores.rows
    record = None if end.subsample.complete or not end.blocks else end.blocks.whole()
    factor = found.scores.forgetting if found.scores else 1.0
    if found.scores and factor < 1.0:
        per_row = factor**end.subsample.thin
        rows, record = faded(rows, per_row), record and record.faded(factor)
        found = replace(found, scores=replace(found.scores, forgetting=per_row))
    sizes = found.fit.estimates[own:]
    additions = shapes.sized(sizes) if shapes else ()
    return Problem(rows, found, own, record, model, lead, joints, additions)


def _aligned(estimator: BaseEstimator, initial: Array, rows: Rows, robot: Robot) -> Aligned:
    """The estimation with the delay of the torques, and with the ringing of friction if it can."""
    try:
        return _with_delay(estimator, initial, with_ringing(rows, robot), robot)
    except NotIdentifiableError:
        return _with_delay(estimator, initial, rows, robot)


def _with_delay(estimator: BaseEstimator, initial: Array, rows: Rows, robot: Robot) -> Aligned:
    """The estimation with the delay of the torques, and with nuisance parameters from 0."""
    further = rows.W.shape[2] - len(initial)
    start = np.append(initial, np.zeros(further))
    found = estimator.widened(further).quick().of_rows(thinned(rows), start)
    wide, theta = estimator.widened(further + 1), found.fit.estimates
    own = len(initial)
    possible = partial(_possible, _diagonals(robot, rows)) if own == len(robot.parameters) else None
    return aligned(wide, np.append(start, 0.0), rows, theta, own, possible)


def _diagonals(robot: Robot, rows: Rows) -> Array:
    """The rows (joints, parameters) of the mean diagonal of the inertia matrix along the record."""
    model = Model(robot, list(range(len(robot.parameters))))
    return np.asarray(model.inertias(few(rows.motion[0])).mean(axis=1))


def _possible(diagonals: Array, theta: Array) -> bool:
    """Whether estimates have no inertia below 0."""
    return bool(np.all(diagonals @ theta >= 0.0))


def _noise(problem: Problem, diagnostics: Diagnostics, counted: int) -> Noise:
    """How much larger the variances are than those for white residuals, as a median."""
    rows = float(counted)
    if noise := problem.found.noise:
        rows = float(np.count_nonzero(problem.rows.scales[noise.kept(problem.rows)]))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = (diagnostics.scatter / problem.found.fit.standard_errors()) ** 2
    return Noise(rows, median(ratios[: problem.own]), diagnostics.blocks)


def _excitation(problem: Problem) -> Array:
    """The root-mean-square torque per unit of each parameter (parameters)."""
    counts = (problem.rows.scales > 0.0).astype(np.float64)
    W = problem.rows.W[:, :, : problem.own]
    # Joint by joint, as a copy of W without the rows that do not count would take longer.
    squares = sum(np.einsum("sp,sp,s->p", W[:, j], W[:, j], k) for j, k in enumerate(counts.T))
    return np.asarray(np.sqrt(squares / max(counts.sum(), 1.0)))
