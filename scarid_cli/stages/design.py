"""Plan an experiment: what is asked of a motion, what limits it, and what it will tell."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import groupby

import numpy as np
import pyarrow as pa

from scarid_cli.algorithms.design.constraints import Law, Torque
from scarid_cli.algorithms.design.model import Model
from scarid_cli.algorithms.design.prediction import (
    Moments,
    logarithm,
    relative,
    standard_errors,
    unknown,
)
from scarid_cli.algorithms.regression.rows import rows_of, with_delay
from scarid_cli.algorithms.regression.treatment import Treatment
from scarid_cli.algorithms.robots.description import Robot
from scarid_cli.algorithms.trajectories.curve import Curve
from scarid_cli.algorithms.trajectories.limits import Limits
from scarid_cli.algorithms.trajectories.trajectory import Trajectory
from scarid_cli.arrays import Array
from scarid_cli.errors import UsageFault, bad_data
from scarid_cli.io import schemas
from scarid_cli.io.table import Metadata, Table, table_of
from scarid_cli.stages.results.estimates import estimates_with_covariance
from scarid_cli.stages.trajgen import samples

ACTIVE = 5e-3  # of a limit: a motion that comes so near is limited by it


@dataclass(frozen=True)
class Earlier:
    """What earlier experiments told: information (parameters, parameters), noise (joints)."""

    information: Array
    noise: Array


def earlier(table: Table, robot: Robot) -> Earlier:
    """The content of a parameter table, with the covariance in its metadata.

    Robust errors are larger than those of a white residual. The noise is that white one that
    causes errors of their size.
    """
    batches = list(table.batches)
    found = estimates_with_covariance(replace(table, batches=iter(batches)), robot)
    facts = table.meta.extra.get("joints")
    if found.remark or not facts:
        raise bad_data(
            table.name,
            "no covariance of the estimates",
            expected="that of an earlier experiment, in the metadata",
            remedy="write the table with `identify -o parameters.parquet`",
        )
    known_ones = np.flatnonzero(np.isfinite(np.diag(found.covariance)))
    information = np.zeros(found.covariance.shape)
    block = np.ix_(known_ones, known_ones)
    information[block] = np.linalg.inv(found.covariance[block])
    deviations = np.array([joint["deviation"] for joint in facts], dtype=np.float64)
    return Earlier(information, deviations * _growth(pa.Table.from_batches(batches)))


def _growth(whole: pa.Table) -> float:
    """The median ratio of robust errors to those of a white residual; 1 if either is missing."""
    if not {"robust_error", "standard_error"} <= set(whole.column_names):
        return 1.0
    robust, white = (
        whole.column(name).to_numpy().astype(np.float64)
        for name in ("robust_error", "standard_error")
    )
    ratios = robust[white > 0.0] / white[white > 0.0]
    ratios = ratios[np.isfinite(ratios)]
    return float(np.median(ratios)) if len(ratios) else 1.0


def laws(robot: Robot, home: Array, workspace: tuple[float, ...] | None) -> tuple[Law, ...]:
    """What an optimised motion must keep beside its limits of position, velocity, acceleration."""
    found: list[Law] = []
    torques = np.array([joint.torque_limit for joint in robot.joints])
    if np.isfinite(torques).any():
        found.append(Torque(Model.of(robot), torques))
    if workspace and not robot.body:
        raise UsageFault(f"--workspace: robot {robot.name} has no URDF, so its tool is not known")
    if robot.body:
        from scarid_cli.algorithms.design.geometry import Apart, Workspace

        if workspace:
            found.append(Workspace.of(robot.body, workspace))
        apart = Apart.of(robot.body, home)
        found += [apart] if apart.names else []
    rest = np.zeros((len(home), 1))
    for law in found:
        broken = np.flatnonzero(law.exact.violations((home[:, None], rest, rest))[:, 0] > 0.0)
        if len(broken):
            raise UsageFault(
                f"--home: at rest there, the {law.names[broken[0]]} is beyond its limit; give "
                "another home position"
            )
    return tuple(found)


def limiting(curve: Curve, limits: Limits, margins: list[Array], kept: tuple[Law, ...]) -> str:
    """What limits a motion, in words."""
    below, above, dq, ddq = curve.largest()
    close = 1.0 - ACTIVE
    ends = (below >= close * (curve.home - limits.lower)) | (
        above >= close * (limits.upper - curve.home)
    )
    found = [
        f"{signal} of joint {i + 1}"
        for signal, near in (
            ("position", ends),
            ("velocity", dq >= close * limits.dq),
            ("acceleration", ddq >= close * limits.ddq),
        )
        for i in np.flatnonzero(near).tolist()
    ]
    for law, margin in zip(kept, margins, strict=True):
        found += [law.names[i] for i in np.flatnonzero(margin >= -ACTIVE)]
    groups = groupby(found, lambda name: name.partition(" of joint ")[0])
    return ", ".join(_together(name, list(members)) for name, members in groups) or "nothing"


def _together(name: str, members: list[str]) -> str:
    """`velocity of joints 1, 3 to 5` for the joints of one limit."""
    numbers = [int(member.rpartition(" ")[2]) for member in members if " of joint " in member]
    if not numbers:
        return name
    runs = [
        [number for _, number in run]
        for _, run in groupby(enumerate(numbers), lambda pair: pair[1] - pair[0])
    ]
    words = [f"{r[0]} to {r[-1]}" if len(r) > 2 else ", ".join(map(str, r)) for r in runs]
    return f"{name} of joint{'s' if len(numbers) > 1 else ''} {', '.join(words)}"


def _treated(robot: Robot, motion: tuple[Array, ...], h: float, treatment: Treatment) -> Array:
    """W (samples, joints, parameters) without slow rows, and with the delay as a parameter."""
    q, dq, ddq = motion
    slow = np.array(treatment.slow) if treatment.slow else None
    rows = rows_of(
        robot, np.array([q, dq, ddq, np.zeros_like(q)]), np.arange(q.shape[1]), h, slow=slow
    )
    if treatment.align:
        rows = with_delay(rows, robot.apriori)
    return rows.W * rows.scales[:, :, None]


@dataclass(frozen=True)
class Prediction:
    """What a motion will tell about a robot; without noise (joints), only how well it excites.

    `moments` are those of all rows, `fitted` those of the rows as they will be identified.
    """

    robot: Robot
    moments: Moments
    fitted: Moments
    noise: Array | None
    known: Array

    @classmethod
    def of(
        cls,
        trajectory: Trajectory,
        robot: Robot,
        rate: float,
        noise: Array | None,
        known: Array,
        treatment: Treatment,
    ) -> Prediction:
        """From the rows of the trajectory's table, at this rate [Hz]."""
        W = (robot.regressor(*motion) for _, motion in samples(trajectory, rate))
        moments = Moments.of(W)
        if not (treatment.slow or treatment.align):
            return cls(robot, moments, moments, noise, known)
        treated = (
            _treated(robot, motion, 1.0 / rate, treatment)
            for _, motion in samples(trajectory, rate)
        )
        return cls(robot, moments, Moments.of(treated), noise, known)

    @property
    def errors(self) -> Array:
        """The expected standard errors (parameters)."""
        assert self.noise is not None
        information = self.fitted.information(self.noise)
        count = len(self.known)
        information[:count, :count] += self.known
        return standard_errors(information)[:count]

    @property
    def excitation(self) -> str:
        """The condition numbers and the information, in words."""
        plain, scaled = self.moments.conditions
        noise = np.ones(len(self.robot.joints)) if self.noise is None else self.noise
        size = logarithm(self.moments.information(noise) + self.known)
        return (
            f"condition number of W {plain:.4g}, of its scaled columns {scaled:.3g}, "
            f"log det of the information {size:.2f} per parameter"
        )

    @property
    def summary(self) -> str:
        """The expected deviations, in words."""
        if self.noise is None:
            return (
                f"no errors are predicted, as the torque noise of {self.robot.name} is not known; "
                "give --torque-noise"
            )
        errors, parameters = self.errors, self.robot.parameters
        lost = unknown(errors, parameters)
        sizes = 100.0 * relative(errors, parameters)
        sizes[[p.name in lost for p in parameters]] = np.nan
        told = f"unknown: {', '.join(lost) or 'none'}"
        if np.isnan(sizes).all():
            return f"predicted from white torque noise: {told}"
        least, most = np.nanmin(sizes), np.nanmax(sizes)
        name = parameters[int(np.nanargmax(sizes))].name
        return (
            f"predicted relative errors with white torque noise and {self.moments.rows} rows: "
            f"{least:.2g} to {most:.2g} %, largest {name}; {told}"
        )

    def table(self, meta: Metadata) -> Table:
        """The table of expected errors."""
        parameters, errors = self.robot.parameters, self.errors
        names, units = [p.name for p in parameters], [p.unit for p in parameters]
        shares = 100.0 * relative(errors, parameters)
        rows = zip(names, units, self.robot.apriori, errors, shares, strict=True)
        schema = schemas.load("expected").arrow()
        plain, scaled = self.moments.conditions
        extra = {
            "condition_number": plain if np.isfinite(plain) else None,
            "scaled_condition_number": scaled if np.isfinite(scaled) else None,
            "torque_noise": [] if self.noise is None else self.noise.tolist(),
            "rows": self.moments.rows,
            "unknown": unknown(errors, parameters),
        }
        return table_of("trajgen", schema, rows, replace(meta, kind="expected", extra=extra))
