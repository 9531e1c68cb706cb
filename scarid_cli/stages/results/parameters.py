"""The table of identified parameters: written from the outcome of an estimation, and read back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.beyond.additions import Addition
from scarid_cli.algorithms.beyond.catalogue import MISMATCHES
from scarid_cli.algorithms.beyond.model import Model
from scarid_cli.algorithms.changes.evidence import LogEvidence
from scarid_cli.algorithms.effects.additions import Shapes
from scarid_cli.algorithms.inference.diagnostics import Diagnostics
from scarid_cli.algorithms.inference.gains import estimated, widening
from scarid_cli.algorithms.inference.outcome import Outcome
from scarid_cli.algorithms.inference.sentences import left_out_of
from scarid_cli.algorithms.inference.verdict import Evidence, combination, verdict
from scarid_cli.algorithms.regression.information import weakest
from scarid_cli.algorithms.regression.rows import Rows
from scarid_cli.algorithms.regression.shifting import reach
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.arrays import Array, median
from scarid_cli.errors import bad_data
from scarid_cli.io import schemas
from scarid_cli.io.table import Metadata, Table, table_of
from scarid_cli.stages.results.products import PRODUCTS, stored_products

if TYPE_CHECKING:  # cvxpy takes a second to import
    from scarid_cli.algorithms.robots.possible import Possible

EVIDENCE = "evidence"  # key of the metadata
BIASES = "biases"  # key of the evidence
ADDITIONS = "additions"  # key of the metadata
SLOW = "slow"  # key of the metadata: velocities below which rows were left out
GAINS, WIDENED_BY_GAINS = "relative_gains", "widened_by_gains"  # keys of the metadata
CONSISTENT = "consistent"  # key of the metadata
LARGEST = 1e15  # of an estimate, in any unit: beyond it sums of squares overflow


@dataclass(frozen=True)
class Identified:
    """The content of a parameter table: the robot as it was identified, and its parameters.

    `theta` (parameters) are the estimates; `delay` [s] is the time by which the torques led the
    motion, 0 if it was not fitted, and with `low_pass` they led as behind a low-pass. `additions`
    are what the torques are beside the model.
    """

    robot: Robot
    theta: Array
    delay: float
    low_pass: bool = False
    additions: tuple[Addition, ...] = ()

    def torques(self, rows: Rows) -> Array:
        """The predicted torques (joints, samples) of rows, without the delay."""
        torques = self.robot.torques(rows.W, self.theta)
        return torques + self.shapes.torques(rows).T if self.additions else torques

    def reach(self, period: float) -> int:
        """The samples on either side without which no torque is predicted, `period` [s] apart."""
        own = [MISMATCHES[x.name].reach(period) for x in self.additions if x.mismatch]
        return max(own, default=0) + reach(self.delay, period, low_pass=self.low_pass)

    @property
    def left_out(self) -> list[str]:
        """What a model lacks that has these parameters alone."""
        estimates = dict(zip(self.robot.names, self.theta.tolist(), strict=True))
        return left_out_of(estimates, self.additions, self.robot)

    @property
    def model(self) -> Model:
        """The robot, with all of its parameters."""
        return Model(self.robot, list(range(len(self.theta))))

    @property
    def shapes(self) -> Shapes:
        """The shapes of what the torques are beside the model."""
        return Shapes(self.additions, self.model, self.theta)


def identified(table: Table, robot: Robot) -> Identified:
    """The content of a parameter table, whose parameters must be those of this robot.

    Parameters of Stribeck friction, which the estimator `separable` adds, are allowed as well.
    """
    batches = list(table.batches)
    names = [name for batch in batches for name in batch.column("parameter").to_pylist()]
    if not names:
        raise bad_data(
            table.name, "no rows", expected="one for each parameter",
            remedy="give the table that identify wrote",
        )  # fmt: skip
    columns = [batch.column("estimate").to_numpy(zero_copy_only=False) for batch in batches]
    values = np.concatenate(columns).astype(float)
    found = dict(zip(names, values.tolist(), strict=True))
    joints = range(1, len(robot.joints) + 1)
    velocities = {i: found[f"vs{i}"] for i in joints if f"vs{i}" in found}
    wanted = [*robot.names, *(f"{kind}{i}" for kind in ("Fst", "vs") for i in velocities)]
    if names != wanted:
        raise bad_data(
            table.name,
            f"the parameters {', '.join(names)}",
            expected=f"those of {robot.name}: {', '.join(robot.names)}",
            remedy="give the robot that they were identified for with --robot",
            column="parameter",
        )
    sound = np.abs(values) <= LARGEST
    if not sound.all():
        worst = int(np.flatnonzero(~sound)[0])
        raise bad_data(
            table.name,
            f"the estimate {values[worst]:g} of {names[worst]}",
            expected="finite numbers of a robot",
            remedy="give the table that identify wrote",
            column="estimate",
        )
    theta = values[: len(values) - len(velocities)]
    delay = float(table.meta.extra.get("delay") or 0.0)
    low_pass = bool(table.meta.extra.get("low_pass"))
    additions = tuple(
        Addition(**{key: x for key, x in addition.items() if x is not None})
        for addition in table.meta.extra.get(ADDITIONS, [])
    )
    return Identified(robot.with_stribeck(velocities), theta, delay, low_pass, additions)


def apriori(robot: Robot) -> Table:
    """The a priori values of a description (CAD) as a parameter table, without any errors."""
    schema = pa.schema([schemas.load("parameters").arrow().field(i) for i in range(3)])
    rows = [(p.name, p.unit, p.apriori) for p in robot.parameters]
    return table_of("apriori", schema, rows, Metadata("parameters", robot=robot.name))


@dataclass(frozen=True)
class Labels:
    """Names and units of all parameters of an outcome, and the indices of those that were kept."""

    names: list[str]
    units: list[str]
    kept: list[int]

    @classmethod
    def of(cls, found: Outcome, robot: Robot) -> Labels:
        names = [*robot.names, *(name for name, _ in found.found.added)]
        units = [*(p.unit for p in robot.parameters), *(unit for _, unit in found.found.added)]
        return cls(names, units, found.kept)

    def placed(self, values: Array, otherwise: float) -> list[float]:
        """Values of the kept parameters, extended to all parameters by the value `otherwise`."""
        row = np.full(len(self.names), otherwise)
        row[self.kept] = values
        return row.tolist()


def parameters(
    found: Outcome,
    robot: Robot,
    meta: Metadata,
    treatment: Treatment,
    *,
    variance: str,
    matched: bool = False,
    unexplained: str = "",
    failed: Sequence[str] = (),
    bodies: Possible | None = None,
) -> Table:
    """The parameter table, with the verdict in its metadata.

    `matched` tells that torques and derivatives are known to have passed the same filter, and
    `unexplained` which torques are not explained, if they are few. `failed` are the checks that the
    log did not pass. `bodies` are the estimates that rigid bodies can have, in place of the free
    ones.
    """
    labels = Labels.of(found, robot)
    known_errors = found.diagnostics.covariance
    nan = np.full(len(found.kept), np.nan)
    robust = found.diagnostics.errors if known_errors else nan
    half = robust * found.diagnostics.quantiles
    free = found.found.fit.estimates
    estimates = bodies.estimates[labels.kept] if bodies else free
    low, high = estimates - half, estimates + half
    if bodies:
        low, high = bodies.low[labels.kept], bodies.high[labels.kept]
    errors = found.found.fit.standard_errors(variance=variance)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = 100.0 * errors / np.abs(estimates)
    statistics = (errors, relative, robust, low, high)
    columns: list[Sequence[Any]] = [labels.names, labels.units, labels.placed(estimates, 0.0)]
    columns += [labels.placed(values, np.nan) for values in statistics]
    schema = schemas.load("parameters").arrow()
    if robot.body:
        written = [p.stands_for or p.name for p in robot.parameters]
        columns.append([*written, *labels.names[len(written) :]])
    else:
        schema = schema.remove(schema.get_field_index("stands_for"))
    evidence = replace(
        _evidence(found, labels, treatment), matched=matched, unexplained=unexplained, failed=failed
    )
    if bodies:
        evidence = replace(evidence, estimates=estimates, bodies=bodies)
    extra = _judged(evidence, robot) | _facts(found, labels)
    if treatment.slow:
        extra[SLOW] = list(treatment.slow)
    if bodies:
        extra[CONSISTENT] = {"distance": bodies.distance, "explained": bodies.explained}
        extra["full_estimates"] = found.full.estimates.tolist()
    return table_of("identify", schema, zip(*columns, strict=True), replace(meta, extra=extra))


def _evidence(found: Outcome, labels: Labels, treatment: Treatment) -> Evidence:
    """What the verdict is based on."""
    fit = found.found.fit
    names = [labels.names[i] for i in labels.kept]
    scaled, direction = weakest(fit.unit_covariance)
    return Evidence(
        names=names,
        estimates=fit.estimates,
        condition=fit.condition,
        scaled_condition=scaled,
        weak=combination(direction, names),
        diagnostics=found.diagnostics,
        treatment=treatment,
    )


def _judged(evidence: Evidence, robot: Robot) -> dict[str, Any]:
    """The metadata of the verdict, with the condition numbers that it is based on."""
    judged = verdict(evidence, robot)
    return {
        "condition_number": _or_none(evidence.condition),
        "scaled_condition_number": evidence.scaled_condition,
        "verdict": judged.grade,
        "reasons": list(judged.reasons),
        "biased": judged.biased,
    }


def _facts(found: Outcome, labels: Labels) -> dict[str, Any]:
    """The remaining metadata of the estimation."""
    fit = found.found.fit
    # The residual of weighted rows is near 1 and means nothing; `joints` has that of each joint.
    meaningful = fit.variance >= 0.0 and not found.found.weighted
    extra: dict[str, Any] = {
        "residual_deviation": float(np.sqrt(fit.variance)) if meaningful else None,
        "samples": found.samples,
        "excitation": dict(zip(labels.names, found.excitation.tolist(), strict=False)),
        "joints": _joints(found.diagnostics),
        "effects": _effects(found.diagnostics),
        "widened": _widened(found.diagnostics),
        "torque_constants": _torque_constants(found, labels),
        **found.found.extra,
    }
    if np.isfinite(found.evidence.score).all():
        extra[EVIDENCE] = stored(found.evidence, labels.names) | {BIASES: _biases(found, labels)}
    if kept := stored_products(found):
        extra[PRODUCTS] = kept
    if found.diagnostics.additions:
        extra[ADDITIONS] = [asdict(addition) for addition in found.diagnostics.additions]
    if told := estimated(found.diagnostics, len(found.kept)):
        extra[GAINS] = {str(x.joint + 1): [x.factor, x.error] for x in told}
    if wide := widening(found.diagnostics, len(found.kept)):
        extra[WIDENED_BY_GAINS] = [x.tolist() for x in wide]
    extra |= {k: n for k, n in (("thinned", found.thin), ("every_part", found.stride)) if n > 1}
    if np.isfinite(found.covariance).all():
        extra["covariance"] = found.covariance.tolist()
    if found.delay:
        extra["delay"], extra["delay_error"] = map(_or_none, found.delay)
        extra["low_pass"] = found.low_pass
    if found.reduction and found.reduction.dropped:
        extra["dropped"] = [labels.names[i] for i in found.reduction.dropped]
        extra["dropped_cost"] = found.reduction.cost
        extra["dropped_allowed"] = found.reduction.allowed
        extra["full_estimates"] = found.full.estimates.tolist()
    return extra


def _torque_constants(found: Outcome, labels: Labels) -> dict[str, list[float]]:
    """How far each estimate moves per relative change of the torque constant of each joint."""
    moves = found.diagnostics.gains.T
    if not np.isfinite(moves).all():
        return {}
    return dict(zip([labels.names[i] for i in found.kept], moves.tolist(), strict=False))


def _joints(diagnostics: Diagnostics) -> list[dict[str, Any]]:
    """The facts of each joint: of its residual, and how well its torque and inertia are known."""
    found = asdict(diagnostics.consequences)
    facts = [asdict(joint) for joint in diagnostics.joints]
    return [
        {
            **{fact: _or_none(value) for fact, value in residual.items()},
            "held_out": _or_none(found["held_out"][i]),
            "torque_error": _or_none(found["torque"][i]),
            "inertia_error": _or_none(found["inertia"][i]),
            "needed": _or_none(diagnostics.needed[i]),
        }
        for i, residual in enumerate(facts)
    ]


def _widened(diagnostics: Diagnostics) -> float | None:
    """The median ratio of the errors to those of leaving out blocks, which noise alone causes."""
    if diagnostics.covariance is None:
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = diagnostics.errors / diagnostics.covariance.errors
    return _or_none(median(ratios))


def _effects(diagnostics: Diagnostics) -> dict[str, Any]:
    """Of each alternative to the model: its statistic, and the share of the errors it adds."""
    scatter = diagnostics.scatter[: len(diagnostics.errors)]
    with np.errstate(divide="ignore", invalid="ignore"):
        return {
            effect.name: {
                "statistic": _or_none(effect.largest),
                "significant": effect.significant(),
                "bias_in_errors": [_or_none(x) for x in (effect.bias / scatter).tolist()],
            }
            for effect in diagnostics.effects
        }


def _biases(found: Outcome, labels: Labels) -> list[list[float]]:
    """How far each alternative to the model moves the estimates beyond noise, if it does."""
    moves = [effect.bias for effect in found.diagnostics.effects if np.any(effect.bias)]
    return [labels.placed(np.nan_to_num(bias), 0.0) for bias in moves]


def stored(found: LogEvidence, columns: list[str]) -> dict[str, Any]:
    """Evidence as the metadata keep it: the lower triangle of the information, row by row."""
    return {
        "columns": columns,
        "information": found.information[np.tril_indices(len(found.score))].tolist(),
        "score": found.score.tolist(),
        "deviations": found.deviations.tolist(),
        "blocks": found.blocks,
    }


def _or_none(value: float) -> float | None:
    """JSON has no nan and no infinity."""
    return float(value) if np.isfinite(value) else None
